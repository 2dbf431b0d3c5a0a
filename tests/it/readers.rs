//! Mesh files: written files read back, broken files are refused by line or byte, and no bytes make a reader panic.

mod beside;
mod broken;
mod bytes;
mod doubled;
mod everything;
mod foreign;
mod gltf;
mod kinds;
mod packed;
mod repairs;
mod round_trips;
mod tags;
mod threemf;
mod usda;

use planish::input::{ReadLimits, ReadMesh, named};

use crate::support::nets::Net;

/// Reads bytes in a format.
fn read(format: &str, bytes: &[u8]) -> Result<ReadMesh, Vec<String>> {
    (named(format).expect("the reader exists").read)(&bytes.into(), &ReadLimits::default())
}

/// Reads valid bytes.
fn mesh(format: &str, bytes: &[u8]) -> ReadMesh {
    read(format, bytes).unwrap_or_else(|faults| panic!("{format}: {faults:?}"))
}

/// Returns positions and faces.
fn net(mesh: &ReadMesh) -> Net {
    let faces = (0..mesh.faces.len()).map(|f| mesh.faces.face(f).iter().map(|&v| v as usize).collect()).collect();
    Net { positions: mesh.positions.clone(), faces }
}

/// Returns the messages about invalid bytes.
fn sentences(format: &str, bytes: &[u8]) -> Vec<String> {
    read(format, bytes).expect_err("it is refused")
}

//! A reader of GLB for the tests: positions, attributes and triangles, in any encoding.

use meshoptimizer_rs::Workspace;
use meshoptimizer_rs::codec::{BufferView, Filter, Mode};
use serde_json::Value;

/// A document with the decoded bytes of its views.
pub(super) struct Model {
    pub(super) document: Value,
    views: Vec<Vec<u8>>,
}

impl Model {
    pub(super) fn of(glb: &[u8]) -> Self {
        let length = u32::from_le_bytes([glb[12], glb[13], glb[14], glb[15]]) as usize;
        let document: Value = serde_json::from_slice(&glb[20..20 + length]).expect("JSON");
        Self::of_parts(document, &[&glb[28 + length..]])
    }

    /// Creates a model from a document and its buffers; the last buffer of the document may be missing.
    pub(super) fn of_parts(document: Value, buffers: &[&[u8]]) -> Self {
        let bytes = |told: &Value| {
            let start = told.get("byteOffset").map_or(0, Self::number);
            buffers[Self::number(&told["buffer"])][start..start + Self::number(&told["byteLength"])].to_vec()
        };
        let view = |view: &Value| {
            let Some(told) = view.pointer("/extensions/EXT_meshopt_compression") else { return bytes(view) };
            let mode = Mode::parse(told["mode"].as_str().expect("a mode")).expect("a known one");
            let filter = told.get("filter").map_or("NONE", |filter| filter.as_str().expect("a filter"));
            let [count, stride] = ["count", "byteStride"].map(|name| Self::number(&told[name]));
            let layout = BufferView::new(mode, Filter::parse(filter).expect("known"), count, stride).expect("a layout");
            layout
                .validate_parent(Self::number(&view["byteLength"]), view.get("byteStride").map(Self::number))
                .expect("");
            layout.decode(&bytes(told), &mut Workspace::default()).expect("a stream")
        };
        let views = document["bufferViews"].as_array().expect("views").iter().map(view).collect();
        Self { document, views }
    }

    pub(super) fn number(value: &Value) -> usize {
        usize::try_from(value.as_u64().expect("a whole number")).expect("small")
    }

    fn primitives(&self) -> Vec<&Value> {
        let meshes = self.document["meshes"].as_array().expect("meshes").iter();
        meshes.flat_map(|mesh| mesh["primitives"].as_array().expect("primitives")).collect()
    }

    pub(super) fn n_primitives(&self) -> usize {
        self.primitives().len()
    }

    /// Returns the rows of an accessor; normalized integers as -1..1 or 0..1.
    fn accessor(&self, accessor: &Value) -> Vec<Vec<f64>> {
        let accessor = &self.document["accessors"][Self::number(accessor)];
        let width = match accessor["type"].as_str().expect("a type") {
            "SCALAR" => 1,
            "VEC2" => 2,
            "VEC3" => 3,
            _ => 4,
        };
        let view = &self.document["bufferViews"][Self::number(&accessor["bufferView"])];
        let bytes = &self.views[Self::number(&accessor["bufferView"])];
        let kind = Self::number(&accessor["componentType"]);
        let size = match kind {
            5120 | 5121 => 1,
            5122 | 5123 => 2,
            _ => 4,
        };
        let is_normalized = accessor.get("normalized").is_some_and(|flag| flag == true);
        let number = |b: &[u8]| {
            let (x, full) = match kind {
                5120 => (f64::from(i8::from_le_bytes([b[0]])), 127.0),
                5123 => (f64::from(u16::from_le_bytes([b[0], b[1]])), 65_535.0),
                5125 => (f64::from(u32::from_le_bytes([b[0], b[1], b[2], b[3]])), 1.0),
                5126 => (f64::from(f32::from_le_bytes([b[0], b[1], b[2], b[3]])), 1.0),
                other => panic!("component type {other}"),
            };
            if is_normalized { x / full } else { x }
        };
        let (start, stride) = (
            accessor.get("byteOffset").map_or(0, Self::number),
            view.get("byteStride").map_or(size * width, Self::number),
        );
        let row = |i: usize| {
            let row = &bytes[start + i * stride..][..size * width];
            row.chunks_exact(size).map(number).collect::<Vec<f64>>()
        };
        let rows: Vec<Vec<f64>> = (0..Self::number(&accessor["count"])).map(row).collect();
        for (name, pick) in [("min", f64::min as fn(f64, f64) -> f64), ("max", f64::max)] {
            let Some(told) = accessor.get(name) else { continue };
            for k in 0..width {
                let found = rows.iter().map(|row| row[k]).reduce(pick).expect("a row");
                assert!((told[k].as_f64().expect("a number") - found).abs() <= 1e-6 * found.abs(), "{name} {told}");
            }
        }
        rows
    }

    /// Returns the rows of an attribute of a primitive.
    pub(super) fn rows(&self, primitive: usize, name: &str) -> Vec<Vec<f64>> {
        self.accessor(&self.primitives()[primitive]["attributes"][name])
    }

    /// Returns the positions of the vertices of a primitive in the scene.
    pub(super) fn places(&self, primitive: usize) -> Vec<[f64; 3]> {
        let nodes = self.document["nodes"].as_array().expect("nodes");
        let counts = self.document["meshes"].as_array().expect("meshes").iter();
        let owners = counts
            .enumerate()
            .flat_map(|(m, mesh)| std::iter::repeat_n(m, mesh["primitives"].as_array().expect("primitives").len()));
        let mesh = owners.collect::<Vec<_>>()[primitive];
        let mut node = nodes.iter().position(|node| node["mesh"] == mesh);
        let mut places: Vec<[f64; 3]> =
            self.rows(primitive, "POSITION").iter().map(|row| [row[0], row[1], row[2]]).collect();
        while let Some(i) = node {
            assert!(nodes[i].get("matrix").is_none(), "the test has no turned meshes");
            let vector = |name: &str, otherwise: f64| {
                [0, 1, 2].map(|k| nodes[i].get(name).map_or(otherwise, |v| v[k].as_f64().expect("a number")))
            };
            let (scale, translation) = (vector("scale", 1.0), vector("translation", 0.0));
            places.iter_mut().for_each(|place| *place = [0, 1, 2].map(|k| scale[k] * place[k] + translation[k]));
            let is_parent = |node: &Value| {
                node.get("children")
                    .is_some_and(|children| children.as_array().expect("a list").iter().any(|c| *c == i))
            };
            node = nodes.iter().position(is_parent);
        }
        places
    }

    pub(super) fn triangles(&self, primitive: usize) -> Vec<[usize; 3]> {
        let rows = self.accessor(&self.primitives()[primitive]["indices"]);
        let corners: Vec<usize> = rows.iter().map(|row| format!("{}", row[0]).parse().expect("an index")).collect();
        corners.as_chunks().0.to_vec()
    }

    /// Returns the input faces of the triangles of a primitive.
    pub(super) fn faces(&self, primitive: usize) -> Vec<u64> {
        let rows = self.accessor(&self.primitives()[primitive]["extras"]["faces"]);
        rows.iter().map(|row| format!("{}", row[0]).parse().expect("an index")).collect()
    }
}

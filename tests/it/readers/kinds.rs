//! Reading of the various ways in which programs write files.

use planish::input::{ChannelInput, FaceSet};
use planish::shape::check::Winding;

use super::{mesh, net, sentences};
use crate::support::nets::Net;

/// Returns a square of two triangles.
fn square() -> Net {
    let positions = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
    Net { positions, faces: vec![vec![0, 1, 2], vec![0, 2, 3]] }
}

fn set(name: &str, faces: &[u64]) -> FaceSet {
    FaceSet { name: name.to_owned(), faces: faces.to_vec() }
}

#[test]
fn obj_counts_from_one_or_backwards_and_lines_go_on() {
    let text = "\u{feff}# a square\r\nv 0 0 0 1.0\r\nv 1 0 0\nv 1 1 \\\n 0\nv 0 1 0 # the last\n\
                f 1/ 2/ 3/\nf -4 -2 \\\r\n -1\n";
    assert_eq!(net(&mesh("obj", text.as_bytes())), square());
}

#[test]
fn lines_may_end_in_carriage_returns_alone() {
    let obj = "# a square\rv 0 0 0\rv 1 0 0\rv 1 1 \\\r 0\rv 0 1 0 # the last\rf 1 2 3\rf 1 3 4";
    assert_eq!(net(&mesh("obj", obj.as_bytes())), square());
    let off = "OFF\r4 2 0\r0 0 0\r1 0 0\r1 1 0\r0 1 0\r3 0 1 2\r3 0 2 3\r";
    assert_eq!(net(&mesh("off", off.as_bytes())), square());
}

#[test]
fn obj_faces_may_come_before_their_vertices() {
    let text = "f 1 2 3\nf 1 3 4\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";
    assert_eq!(net(&mesh("obj", text.as_bytes())), square());
}

#[test]
fn obj_keeps_texture_coordinates_groups_materials_and_colours() {
    let text = "mtllib a.mtl\no thing\nv 0 0 0 1 0 0\nv 1 0 0 0 1 0\nv 1 1 0 0 0 1\nv 0 1 0 .5 .5 .5\n\
                vt 0 0\nvt 1 0 0\nvt 1 1\nvt 0 1\nvn 0 0 1\ng left all\nusemtl my red#1\ns off\nf 1/1/1 2/2/1 3/3/1\n\
                g right all\nusemtl blue # not red\nf 1/1/1 3/3/1 4/4/1\nl 1 2\np 1\nl 3 4\n";
    let found = mesh("obj", text.as_bytes());
    let uvs = found.uvs.expect("it has them");
    assert_eq!(uvs.values, [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]);
    assert_eq!(uvs.corners, [0, 1, 2, 0, 2, 3]);
    assert_eq!(found.groups, [set("left", &[0]), set("all", &[0, 1]), set("right", &[1]), set("thing", &[0, 1])]);
    assert_eq!(found.materials, [set("my red#1", &[0]), set("blue", &[1])]);
    let values = vec![1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.5, 0.5, 0.5];
    assert_eq!(found.channels, [ChannelInput::of_vertices("color", 3, values)]);
    assert_eq!(found.notes[..2], ["lines are left out: 2", "points are left out: 1"]);
    assert!(found.notes[2].contains("\"a.mtl\" lies outside the file"), "{:?}", found.notes);
}

/// `g default` is OBJ's notation for faces in no group.
#[test]
fn obj_faces_of_the_default_group_are_in_none() {
    let text =
        "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\ng default\nusemtl red\nf 1 2 3\ng top default\nusemtl default\nf 1 3 4\n";
    let found = mesh("obj", text.as_bytes());
    assert_eq!(found.groups, [set("top", &[1])]);
    assert_eq!(found.materials, [set("red", &[0])]);
}

/// Names in files may be any text; those of a mesh have no blanks, and a face is in one group.
#[test]
fn names_and_channels_become_those_of_a_mesh() {
    let text = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\no a thing\ng left all\nusemtl my red#1\nf 1 2 3\ng all\nf 1 3 4\n";
    let input = mesh("obj", text.as_bytes()).into_input(Winding::Refuse);
    let groups = [set("left", &[0]), set("all", &[1])];
    assert_eq!(input.attachments.groups, groups);
    assert_eq!(input.attachments.materials, [set("my_red_1", &[0, 1])]);
    let of_looks = "how materials look is not told: the file names no library (mtllib), only materials";
    assert_eq!(input.notes, [of_looks, "faces in more than one group are kept in the first: 3"]);
    let mut found = mesh("obj", text.as_bytes());
    let channel = |name: &str| ChannelInput::of_vertices(name, 1, vec![0.0; 4]);
    found.channels = vec![channel("heat"), channel("two words"), channel("heat")];
    let input = found.into_input(Winding::Refuse);
    assert_eq!(input.attachments.channels, [channel("heat")]);
    assert!(input.notes[1].starts_with("the numbers \"two words\" of vertices are left out: "), "{:?}", input.notes);
    assert!(input.notes[2].starts_with("the numbers \"heat\" of vertices are left out: "), "{:?}", input.notes);
}

#[test]
fn ply_takes_any_types_and_orders_and_keeps_further_numbers() {
    let header = "comment by hand\nobj_info none\nelement material 1\nproperty list uchar float factors\n\
                  element vertex 4\nproperty uchar blue\nproperty double y\nproperty short x\nproperty float z\n\
                  property uchar green\nproperty uchar red\nproperty int heat\nproperty float nx\nproperty float ny\n\
                  property float nz\nelement face 2\nproperty int quality\nproperty list ushort int vertex_index\n\
                  end_header\n";
    // blue, y, x, z, green, red, heat
    let vertices =
        [(255, 0, 0, 0, 0, 0, 7), (0, 0, 1, 0, 255, 0, -8), (0, 1, 1, 0, 0, 255, 9), (51, 1, 0, 0, 51, 51, 0)];
    let mut ascii = format!("ply\nformat ascii 1.0\n{header}3 1 2 3\n");
    let mut little = format!("ply\nformat binary_little_endian 1.0\n{header}").into_bytes();
    let mut big = format!("ply\r\nformat binary_big_endian 1.0\r\n{}", header.replace('\n', "\r\n")).into_bytes();
    let mut put = |ascii_text: &str, bytes: &[u8]| {
        ascii.push_str(ascii_text);
        little.extend_from_slice(bytes);
        big.extend(bytes.iter().rev());
    };
    put("", &[3]);
    [1.0_f32, 2.0, 3.0].iter().for_each(|x| put("", &x.to_le_bytes()));
    for (blue, y, x, z, green, red, heat) in vertices {
        put(&format!("{blue} "), &u8::to_le_bytes(blue));
        put(&format!("{y} "), &f64::from(y).to_le_bytes());
        put(&format!("{x} "), &i16::to_le_bytes(x));
        put(&format!("{z}.0e0 "), &f32::from(i16::to_le_bytes(z)[0]).to_le_bytes());
        put(&format!("{green} "), &u8::to_le_bytes(green));
        put(&format!("{red}\n"), &u8::to_le_bytes(red));
        put(&format!("{heat} "), &i32::to_le_bytes(heat));
        put("0 0 nan\n", &[]);
        [0.0_f32, 0.0, f32::NAN].iter().for_each(|x| put("", &x.to_le_bytes()));
    }
    for face in [[0, 1, 2], [0, 2, 3_i32]] {
        put("5 3 ", &5_i32.to_le_bytes());
        put("", &3_u16.to_le_bytes());
        face.iter().for_each(|v| put(&format!("{v} "), &v.to_le_bytes()));
    }
    for bytes in [ascii.as_bytes(), &little, &big] {
        let found = mesh("ply", bytes);
        assert_eq!(net(&found), square());
        let colors = vec![0.0, 0.0, 1.0, 0.0, 1.0, 0.0, 1.0, 0.0, 0.0, 0.2, 0.2, 0.2];
        let color = ChannelInput::of_vertices("color", 3, colors);
        let heat = ChannelInput::of_vertices("heat", 1, vec![7.0, -8.0, 9.0, 0.0]);
        assert_eq!(found.channels, [color, heat]);
        let notes = ["elements \"material\" are left out: 1", "properties of faces are left out: \"quality\""];
        assert_eq!(found.notes, notes);
    }
}

#[test]
fn ply_texture_coordinates_belong_to_vertices_or_corners() {
    let start = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n";
    let of_vertices = format!(
        "{start}property float s\nproperty float t\nelement face 1\nproperty list uchar int vertex_indices\n\
         end_header\n\
         0 0 0 0 .25\n1 0 0 1 .5\n0 1 0 0 1\n3 2 0 1\n"
    );
    let uvs = mesh("ply", of_vertices.as_bytes()).uvs.expect("it has them");
    assert_eq!((uvs.values, uvs.corners), (vec![[0.0, 0.25], [1.0, 0.5], [0.0, 1.0]], vec![2, 0, 1]));
    let of_corners = format!(
        "{start}element face 1\nproperty list uchar int vertex_indices\nproperty list uchar float texcoord\n\
         end_header\n\
         0 0 0\n1 0 0\n0 1 0\n3 2 0 1 6 0 .5 1 .5 1 1\n"
    );
    let uvs = mesh("ply", of_corners.as_bytes()).uvs.expect("it has them");
    assert_eq!((uvs.values, uvs.corners), (vec![[0.0, 0.5], [1.0, 0.5], [1.0, 1.0]], vec![0, 1, 2]));
}

fn facet(corners: [[f64; 3]; 3]) -> String {
    let vertices = corners.map(|[x, y, z]| format!("    vertex {x} {y:e} {z}\n")).concat();
    format!("  facet normal 0 0 0\n   OUTER LOOP\n{vertices}   endloop\n  endfacet\n")
}

#[test]
fn stl_joins_equal_corners_and_leaves_out_what_has_no_three() {
    let [a, b, c, d] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [-0.0, 1.0, 0.0]];
    let text = format!(
        "solid one\n{}{}endsolid one\n\nSOLID two words\n{}endsolid\n",
        facet([a, b, c]),
        facet([a, a, c]),
        facet([[-0.0, 0.0, -0.0], c, d])
    );
    let found = mesh("stl", text.as_bytes());
    assert_eq!(net(&found), square());
    assert_eq!(found.groups, [set("one", &[0]), set("two words", &[1])]);
    let note = "triangles left out because two of their corners are equal: 1, the first is triangle 1";
    assert_eq!(found.notes, [note]);
}

/// Line breaks have no meaning in STL text except to end names.
#[test]
fn stl_may_break_its_lines_anywhere() {
    let facets = |text: &str| {
        let found = mesh("stl", text.as_bytes());
        assert_eq!(net(&found), square(), "{text}");
        found.groups
    };
    let a = facet([[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0]]);
    let b = facet([[0.0; 3], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]]);
    let named = "solid facet of a thing\n";
    for text in [
        format!("{named}{a}{b}endsolid of a solid thing\n"),
        format!("{named}{a}{b}endsolid").replace("normal 0 0 0", "normal nan -nan(ind) 1.#QNAN"),
        format!("solid a thing {a}{b}endsolid a thing").replace('\n', " "),
        format!("solid {a}{b}endsolid").split_whitespace().collect::<Vec<_>>().join("\n"),
        format!("{named}{a}{b}endsolid\n").replace('\n', "\r"),
    ] {
        assert_eq!(facets(&text), []);
    }
    let sets = [set("one", &[0]), set("two words", &[1])];
    let two = format!("solid one {a} endsolid one solid two words {b} endsolid");
    assert_eq!(facets(&two.replace('\n', " ")), sets);
    assert_eq!(facets(&two.replace("solid two words", "\nsolid two words\n")), sets);
}

/// Programs write any header before binary triangles, also "solid".
#[test]
fn binary_stl_is_told_by_its_length() {
    let mut bytes = b"solid but binary".to_vec();
    bytes.resize(80, b' ');
    bytes.extend(2_u32.to_le_bytes());
    for face in square().faces {
        bytes.extend([0_u8; 12]);
        let corners = face.iter().flat_map(|&v| square().positions[v]);
        #[expect(clippy::cast_possible_truncation, reason = "small whole numbers")]
        corners.for_each(|x| bytes.extend((x as f32).to_le_bytes()));
        bytes.extend([255_u8, 7]);
    }
    assert_eq!(net(&mesh("stl", &bytes)), square());
}

#[test]
fn off_takes_its_prefixes_comments_and_colours() {
    let plain = "# made by hand\nOFF 4 2 0\n0 0 0\n1 0 0\n\n1 1 0 # a corner\n0 1 0\n3 0 1 2\n3  0 2 3  255 0 0\n";
    let found = mesh("off", plain.as_bytes());
    assert_eq!(net(&found), square());
    assert_eq!(found.notes, ["colours of faces are left out: 1"]);
    let colors = vec![1.0, 0.0, 0.0, 1.0, 0.0, 1.0, 0.0, 1.0, 0.0, 0.0, 1.0, 1.0, 0.2, 0.2, 0.2, 1.0];
    let whole =
        "COFF\n4 2 5\n0 0 0 255 0 0 255\n1 0 0 0 255 0 255\n1 1 0 0 0 255 255\n0 1 0 51 51 51\n3 0 1 2\n3 0 2 3\n";
    let found = mesh("off", whole.as_bytes());
    assert_eq!(found.channels, [ChannelInput::of_vertices("color", 4, colors.clone())]);
    let real = "STCNOFF\n4 2 5\n0 0 0  0 0 1  1.0 0. 0  0 0\n1 0 0  0 0 1  0 1.0 0  1 0\n1 1 0  0 0 1  0 0 1.0  1 1\n\
                0 1 0  0 0 1  .2 .2 .2  0 1\n3 0 1 2\n3 0 2 3\n";
    let found = mesh("off", real.as_bytes());
    assert_eq!(net(&found), square());
    assert_eq!(found.channels, [ChannelInput::of_vertices("color", 4, colors)]);
    let uvs = found.uvs.expect("it has them");
    assert_eq!((uvs.values[2], uvs.corners), ([1.0, 1.0], vec![0, 1, 2, 0, 2, 3]));
}

#[test]
fn off_may_be_binary() {
    // a square of two triangles; the first has a colour, which is ignored
    let words = |numbers: &[u32]| numbers.iter().flat_map(|word| word.to_be_bytes()).collect::<Vec<u8>>();
    let floats = |numbers: &[f32]| numbers.iter().flat_map(|number| number.to_be_bytes()).collect::<Vec<u8>>();
    let corners: [[f32; 3]; 4] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
    let faces = [words(&[3, 0, 1, 2, 3]), floats(&[1.0, 0.0, 0.0]), words(&[3, 0, 2, 3, 0])].concat();
    let plain = [b"OFF BINARY\n".to_vec(), words(&[4, 2, 5]), floats(corners.as_flattened()), faces.clone()].concat();
    let found = mesh("off", &plain);
    assert_eq!(net(&found), square());
    assert_eq!(found.notes, ["colours of faces are left out: 1"]);
    let colored: Vec<f32> = corners.iter().flat_map(|[x, y, z]| [*x, *y, *z, 1.0, 0.5, 0.0, 0.25]).collect();
    let whole = [b"COFF BINARY\n".to_vec(), words(&[4, 2, 5]), floats(&colored), faces, b"\n".to_vec()].concat();
    let found = mesh("off", &whole);
    assert_eq!((net(&found), found.channels[0].values[..4].to_vec()), (square(), vec![1.0, 0.5, 0.0, 0.25]));
    // every shorter file is refused, naming a byte
    for length in 12..plain.len() {
        let told = sentences("off", &plain[..length]);
        assert!(told.iter().all(|sentence| sentence.starts_with("byte ")), "{length}: {told:?}");
    }
}

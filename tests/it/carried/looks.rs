//! Looks of materials: from jobs, through refinement, in files and in pictures.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use proptest::prelude::*;
use serde_json::{Value, json};

use super::files::check_size;
use super::{bytes, indices, job, refusal, told, written};
use crate::support::nets::{self, Net};

/// Returns a square in the plane z = 0 of one or two quads, seen from the front with v upwards.
fn square(n: usize) -> Net {
    let xs = if n == 1 { vec![0.0, 1.0] } else { vec![0.0, 0.5, 1.0] };
    let positions = [0.0, 1.0].iter().flat_map(|&y| xs.iter().map(move |&x| [x, y, 0.0])).collect();
    let row = xs.len();
    Net { positions, faces: (0..n).map(|i| vec![i, i + 1, row + i + 1, row + i]).collect() }
}

/// Returns a PNG with these pixels, row by row from the top.
pub(super) fn png(width: u32, pixels: &[[u8; 3]]) -> Vec<u8> {
    let height = u32::try_from(pixels.len()).expect("few pixels") / width;
    let mut file = std::io::Cursor::new(Vec::new());
    let picture = image::RgbImage::from_raw(width, height, pixels.as_flattened().to_vec()).expect("whole rows");
    picture.write_to(&mut file, image::ImageFormat::Png).expect("a PNG");
    file.into_inner()
}

/// Returns a JPEG of 8 x 8 grey pixels of the value 188, with one coefficient: 480, eight times the excess over the
/// middle.
pub(super) fn jpeg() -> Vec<u8> {
    // one code of one bit, for numbers of nine bits and for the end of a block
    let codes = |kind: u8, symbol: u8| [&[0xff, 0xc4, 0, 20, kind, 1][..], &[0; 15], &[symbol]].concat();
    [
        &[0xff, 0xd8, 0xff, 0xdb, 0, 67, 0][..],
        &[1; 64],
        &[0xff, 0xc0, 0, 11, 8, 0, 8, 0, 8, 1, 1, 0x11, 0],
        &codes(0, 9),
        &codes(16, 0),
        &[0xff, 0xda, 0, 8, 1, 1, 0, 0, 63, 0, 0x78, 0x1f, 0xff, 0xd9],
    ]
    .concat()
}

pub(super) fn uri(kind: &str, file: &[u8]) -> String {
    format!("data:image/{kind};base64,{}", STANDARD.encode(file))
}

/// Returns materials with every field, one without a texture and one with.
fn all() -> Value {
    json!([
        { "name": "red", "faces": [1, 3], "color": [1, 0.25, 0, 0.5], "metallic": 0.75, "roughness": 0.125,
          "alpha_cutoff": 0.25, "alpha_mode": "mask", "double_sided": false },
        { "name": "plain", "faces": [0] },
        { "name": "grey", "faces": [5], "texture": { "wrap_s": "repeat", "wrap_t": "repeat",
                                                      "image": uri("jpeg", &jpeg()) } },
        { "name": "green", "faces": [2, 4], "color": [0, 0.5, 0.1, 1],
          "texture": { "wrap_s": "clamp-to-edge", "wrap_t": "mirrored-repeat", "mag_filter": "nearest",
                       "min_filter": "linear-mipmap-linear",
                       "image": uri("png", &png(2, &[[1, 2, 3], [250, 9, 7]])) } },
    ])
}

fn painted_cube() -> (Net, Value) {
    let net = nets::cube();
    let uvs = json!({ "values": [[0, 0], [1, 0], [1, 1], [0, 1]], "faces": vec![[0, 1, 2, 3]; 6] });
    (net, json!({ "materials": all(), "uvs": uvs }))
}

#[test]
fn json_tells_of_looks_what_jobs_say() {
    let (net, extra) = painted_cube();
    let unrefined = job(&net, &extra, &json!({ "preset": "catmull-clark" }), 0);
    assert_eq!(told(unrefined.clone())["materials"], all());
    let result = told(job(&net, &extra, &json!({ "preset": "catmull-clark" }), 2));
    for (material, given) in result["materials"].as_array().expect("a list").iter().zip(all().as_array().expect("one"))
    {
        let (mut material, mut given) = (material.clone(), given.clone());
        assert_eq!(indices(&material["faces"]).len(), 16 * indices(&given["faces"]).len());
        (material["faces"], given["faces"]) = (json!(null), json!(null));
        assert_eq!(material, given);
    }
    for format in ["json", "gltf", "glb", "png"] {
        let mut one = unrefined.clone();
        one["outputs"] = json!([{ "format": format, "width": 16, "height": 16 }]);
        if format != "png" {
            one["outputs"] = json!([{ "format": format }]);
        }
        check_size(&one);
    }
    // a colour of three numbers is opaque
    let opaque = json!({ "materials": [{ "name": "a", "faces": [0], "color": [0.5, 0.25, 1] }] });
    let opaque = told(job(&net, &opaque, &json!({ "word": "U" }), 0));
    assert_eq!(opaque["materials"][0]["color"], json!([0.5, 0.25, 1, 1]));
}

/// Returns a file as the input of a job.
fn of_file(format: &str, file: &[u8]) -> Value {
    json!({ "input": { "text": { "format": format, "encoding": "base64", "data": STANDARD.encode(file) } } })
}

#[test]
fn looks_come_back_from_gltf_with_their_pictures_byte_for_byte() {
    let (net, extra) = painted_cube();
    let given = job(&net, &extra, &json!({ "preset": "catmull-clark" }), 1);
    let given_looks = told(given.clone())["materials"].clone();
    for format in ["glb", "gltf"] {
        let first = written(&given, &json!({ "format": format }));
        let back = told(of_file(format, &first))["materials"].clone();
        let [red, green, grey] = ["red", "green", "grey"].map(|name| {
            let find = |all: &Value| all.as_array().expect("a list").iter().find(|one| one["name"] == name).cloned();
            [find(&given_looks).expect("as given"), find(&back).expect("as it came back")]
        });
        for [given, back] in [&red, &green] {
            for k in 0..4 {
                let [x, y] = [given, back].map(|one| one["color"][k].as_f64().expect("a number"));
                assert!((x - y).abs() < 1e-6, "{given} {back}");
            }
        }
        for field in ["metallic", "roughness", "double_sided", "alpha_mode", "alpha_cutoff"] {
            assert_eq!(red[0][field], red[1][field], "{field}");
        }
        assert_eq!(green[0]["texture"], green[1]["texture"]);
        assert_eq!(grey[0]["texture"], grey[1]["texture"]);
        assert_eq!(green[1]["alpha_mode"], "opaque");
        let plain = back.as_array().expect("a list").iter().find(|one| one["name"] == "plain").expect("it has faces");
        assert!(plain.get("color").is_none(), "what nobody said is not said: {plain}");
        // from the second time on, nothing changes
        let second = written(&of_file(format, &first), &json!({ "format": format }));
        let third = written(&of_file(format, &second), &json!({ "format": format }));
        assert!(second == third, "{format}");
    }
}

#[test]
fn what_materials_of_gltf_have_besides_is_named() {
    let (net, extra) = painted_cube();
    let file = written(&job(&net, &extra, &json!({ "word": "U" }), 0), &json!({ "format": "gltf" }));
    let mut document: Value = serde_json::from_slice(&file).expect("JSON");
    let materials = document["materials"].as_array_mut().expect("materials");
    let texture = json!({ "index": 0 });
    for material in materials.iter_mut() {
        material["normalTexture"] = texture.clone();
    }
    materials[0]["emissiveFactor"] = json!([0, 1, 0]);
    materials[0]["occlusionTexture"] = texture.clone();
    materials[0]["pbrMetallicRoughness"]["metallicRoughnessTexture"] = texture;
    materials[1]["pbrMetallicRoughness"]["baseColorTexture"] = json!({ "index": 0, "texCoord": 1 });
    document["extensionsUsed"] = json!(["KHR_texture_transform", "KHR_materials_sheen", "KHR_technique_webgl"]);
    let mut job = of_file("gltf", document.to_string().as_bytes());
    job["outputs"] = json!([{ "format": "json" }]);
    let (_, report) = crate::support::render(&job).expect("a mesh");
    let all = report.warnings.join("\n");
    for part in [
        "textures of normals are left out: 4",
        "textures of occlusion are left out: 1",
        "textures of metalness and roughness are left out: 1",
        "light that materials give off is left out: 1",
        "another set of texture coordinates than the first are left out: 1",
        "extensions of materials are left out: \"KHR_texture_transform\", \"KHR_materials_sheen\", \
         \"KHR_technique_webgl\"",
    ] {
        assert!(all.contains(part), "{part} is not in {all}");
    }
}

/// Returns the pixels of a picture of a job, seen straight from the front.
pub(super) fn front(job: &Value, more: &Value) -> image::RgbImage {
    let camera = json!({ "projection": "orthographic", "azimuth_deg": 0, "elevation_deg": 0 });
    let mut output = json!({ "format": "png", "width": 64, "height": 64, "camera": camera });
    for (name, value) in more.as_object().expect("options") {
        output[name] = value.clone();
    }
    image::load_from_memory(&written(job, &output)).expect("a picture").into_rgb8()
}

/// Returns the index of the component among red, green and blue that is largest by far; 3 if there is none.
fn hue(pixel: [u8; 3]) -> usize {
    (0..3).find(|&k| (0..3).all(|j| j == k || u16::from(pixel[k]) > 40 + u16::from(pixel[j]))).unwrap_or(3)
}

#[test]
fn pictures_show_the_colours_of_materials_unless_another_one_is_asked_for() {
    let net = square(2);
    let extra = json!({ "materials": [
        { "name": "left", "faces": [0], "color": [0.9, 0.1, 0.1, 1] },
        { "name": "right", "faces": [1], "color": [0.1, 0.8, 0.1, 1] },
    ] });
    let job = job(&net, &extra, &json!({ "word": "U" }), 1);
    let hues = |more: Value| {
        let picture = front(&job, &more);
        [16, 48].map(|x| hue(picture.get_pixel(x, 32).0))
    };
    assert_eq!(hues(json!({})), [0, 1]);
    assert_eq!(hues(json!({ "shading": "flat" })), [0, 1]);
    assert_eq!(hues(json!({ "color": "#2030f0" })), [2, 2]);
}

#[test]
fn pictures_show_textures_upright_and_as_their_sides_say() {
    let (red, green, blue, grey) = ([230, 0, 0], [0, 200, 0], [0, 0, 230], [120; 3]);
    let file = png(2, &[red, green, blue, grey]);
    let of = |scale: f64, wrap: &str, more: Value| {
        let mut texture = json!({ "image": uri("png", &file), "mag_filter": "nearest", "wrap_s": wrap });
        for (name, value) in more.as_object().expect("fields") {
            texture[name] = value.clone();
        }
        let extra = json!({
            "uvs": { "values": [[0, 0], [scale, 0], [scale, 1], [0, 1]], "faces": [[0, 1, 2, 3]] },
            "materials": [{ "name": "a", "faces": [0], "texture": texture }],
        });
        front(&job(&square(1), &extra, &json!({ "word": "U" }), 0), &json!({}))
    };
    let at = |picture: &image::RgbImage, x: u32, y: u32| hue(picture.get_pixel(x, y).0);
    let once = of(1.0, "repeat", json!({}));
    assert_eq!([at(&once, 16, 16), at(&once, 48, 16), at(&once, 16, 48), at(&once, 48, 48)], [0, 1, 2, 3]);
    // twice as wide: red, green, and the area beyond the picture
    for (wrap, expected) in [("repeat", [0, 1]), ("mirrored-repeat", [1, 0]), ("clamp-to-edge", [1, 1])] {
        let twice = of(2.0, wrap, json!({}));
        assert_eq!([at(&twice, 38, 16), at(&twice, 52, 16)], expected, "{wrap}");
    }
    // without a colour, only the texture determines the shade; a JPEG is read, too
    let extra = json!({
        "uvs": { "values": [[0, 0], [1, 0], [1, 1], [0, 1]], "faces": [[0, 1, 2, 3]] },
        "materials": [{ "name": "a", "faces": [0], "texture": { "image": uri("jpeg", &jpeg()) } }],
    });
    let grey = front(&job(&square(1), &extra, &json!({ "word": "U" }), 0), &json!({}));
    let [r, g, b] = grey.get_pixel(32, 32).0;
    assert!(r.abs_diff(g) < 12 && g.abs_diff(b) < 25 && r > 60, "{r} {g} {b}");
}

#[test]
fn what_no_material_can_look_like_is_refused_where_it_stands() {
    let (net, _) = painted_cube();
    let with = |material: Value, uvs: bool| {
        let mut material = material;
        (material["name"], material["faces"]) = (json!("a"), json!([0]));
        let mut extra = json!({ "materials": [material] });
        if uvs {
            extra["uvs"] = json!({ "values": [[0, 0]], "faces": vec![[0; 4]; 6] });
        }
        refusal(&job(&net, &extra, &json!({ "word": "U" }), 0)).remove(0)
    };
    let picture = uri("png", &png(1, &[[0; 3]]));
    for (material, pointer, part) in [
        (json!({ "color": [0, 1.5, 0, 1] }), "/color/1", "1.5 is not from 0 to 1"),
        (json!({ "color": [0, 1] }), "/color", "2 numbers; a color has 3 or 4"),
        (json!({ "metallic": -0.25 }), "/metallic", "-0.25 is not from 0 to 1"),
        (json!({ "roughness": 2 }), "/roughness", "2 is not from 0 to 1"),
        (json!({ "alpha_mode": "mask", "alpha_cutoff": 3 }), "/alpha_cutoff", "3 is not from 0 to 1"),
        (json!({ "alpha_cutoff": 0.5 }), "/alpha_cutoff", "say so"),
        (json!({ "alpha_mode": "half" }), "/alpha_mode", "unknown choice"),
        (json!({ "texture": { "image": picture } }), "/texture", "no uvs"),
        (json!({ "texture": { "image": "a.png" } }), "/texture/image", "no data URI"),
        (json!({ "texture": { "image": uri("png", b"GIF89a") } }), "/texture/image", "neither PNG nor JPEG"),
        (
            json!({ "texture": { "image": picture, "mag_filter": "nearest-mipmap-linear" } }),
            "/texture/mag_filter",
            "smaller",
        ),
    ] {
        let (found, detail) = with(material, pointer != "/texture");
        assert_eq!(found, format!("/input/mesh/materials/0{pointer}"), "{detail}");
        assert!(detail.contains(part), "{detail}");
    }
    let many: Vec<Value> = (0..257).map(|i| json!({ "name": format!("m{i}"), "faces": [] })).collect();
    let (pointer, detail) = refusal(&job(&net, &json!({ "materials": many }), &json!({ "word": "U" }), 0)).remove(0);
    assert_eq!((pointer.as_str(), detail.as_str()), ("/input/mesh/materials", "257 names; at most 256 are allowed"));
    let beyond = json!({ "materials": [{ "name": "a", "faces": [6], "color": [0, 0, 0] }] });
    let (pointer, _) = refusal(&job(&net, &beyond, &json!({ "word": "U" }), 0)).remove(0);
    assert_eq!(pointer, "/input/mesh/materials/0/faces/0");
    // a truncated picture is detected when it is drawn
    let mut broken = png(4, &[[9; 3]; 16]);
    broken.truncate(broken.len() - 20);
    let extra = json!({ "uvs": { "values": [[0, 0]], "faces": vec![[0; 4]; 6] },
        "materials": [{ "name": "a", "faces": [0], "texture": { "image": uri("png", &broken) } }] });
    let mut job = job(&net, &extra, &json!({ "word": "U" }), 0);
    assert!(!bytes(&json!({ "input": job["input"], "outputs": [{ "format": "glb" }] })).is_empty());
    job["outputs"] = json!([{ "format": "png", "width": 16, "height": 16 }]);
    let faults = crate::support::render(&job).expect_err("it cannot be drawn");
    assert!(faults[0].detail.contains("cannot be decoded"), "{}", faults[0].detail);
}

#[test]
fn pictures_enter_keys_by_their_bytes() {
    let key = |file: &[u8], wrap: &str| {
        let extra = json!({ "uvs": { "values": [[0, 0]], "faces": vec![[0; 4]; 6] },
            "materials": [{ "name": "a", "faces": [0], "texture": { "image": uri("png", file), "wrap_t": wrap } }] });
        let mut job = job(&nets::cube(), &extra, &json!({ "word": "U" }), 0);
        job["outputs"] = json!([{ "format": "glb" }]);
        crate::support::parsed(job.to_string().as_bytes()).expect("a job").keys()[0]
    };
    let [one, other] = [png(1, &[[1; 3]]), png(1, &[[2; 3]])];
    assert_ne!(key(&one, "repeat"), key(&other, "repeat"));
    assert_ne!(key(&one, "repeat"), key(&one, "clamp-to-edge"));
    assert_eq!(key(&one, "repeat"), key(&one, "repeat"));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(32))]

    /// The children of a face have its material under every scheme.
    #[test]
    fn children_have_the_material_of_the_face_they_come_of(
        net in nets::manifold(),
        of in proptest::collection::vec(0..4_usize, 64),
        preset in prop_oneof![Just("catmull-clark"), Just("bilinear"), Just("kobbelt")],
        levels in 0..3_u32,
    ) {
        let faces = |m: usize| (0..net.faces.len()).filter(|f| of[f % of.len()] == m).collect::<Vec<_>>();
        let reds = [0.0, 0.25, 0.5].iter().enumerate();
        let looks: Vec<Value> = reds
            .map(|(m, red)| json!({ "name": format!("m{m}"), "faces": faces(m), "color": [red, 0, 1, 1] }))
            .collect();
        let looks = json!({ "materials": looks });
        let result = told(job(&net, &looks, &json!({ "preset": preset }), levels));
        let origins = indices(&result["ids"]["faces"]);
        let materials = result["materials"].as_array().expect("a list");
        prop_assert_eq!(materials.len(), 3);
        for (m, material) in materials.iter().enumerate() {
            let expected: Vec<usize> = (0..origins.len()).filter(|&f| of[origins[f] % of.len()] == m).collect();
            prop_assert_eq!(indices(&material["faces"]), expected);
            prop_assert_eq!(material["color"][0].as_f64(), looks["materials"][m]["color"][0].as_f64());
        }
    }
}

//! USD as text: cages are read back with all their rules, transforms place prims, and broken or too deep files are
//! refused.

use planish::input::{ReadLimits, named};
use planish::scheme::tags::Boundary;
use planish::shape::coordinate_system::{Unit, Up};
use planish::shape::seams::Interpolation;
use serde_json::{Value, json};

use super::{mesh, sentences};
use crate::support::nets;
use crate::support::render;

const SQUARE: &str = "int[] faceVertexCounts = [4]\nint[] faceVertexIndices = [0, 1, 2, 3]\n\
                      point3f[] points = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)]\n";

fn layer(metadata: &str, prims: &str) -> Vec<u8> {
    format!("#usda 1.0\n({metadata})\n{prims}").into_bytes()
}

fn square(more: &str) -> Vec<u8> {
    layer("", &format!("def Mesh \"a\" {{ {SQUARE} {more} }}"))
}

/// Returns a scene with most features that the reader supports.
pub(super) fn scene() -> String {
    format!(
        r#"#usda 1.0
(
    """A scene
    of several lines # no comment"""
    defaultPrim = "World"
    metersPerUnit = 0.001
    upAxis = "Z"
    customLayerData = {{ string a = "}}" }}
)
# a comment
over "Other" {{ }}
class "Kind" {{ def Mesh "none" {{ {SQUARE} }} }}
def Xform "World" (
    kind = "assembly"
    prepend apiSchemas = ["GeomModelAPI"]
)
{{
    /* the bindings of parents hold below */
    rel material:binding = </Looks/Red>
    double3 xformOp:translate = (10, 0, 0)
    float xformOp:rotateZ.timeSamples = {{ 0: 90, 24: 180, }}
    uniform token[] xformOpOrder = ["xformOp:translate", "xformOp:rotateZ"]
    variantSet "size" = {{ "small" {{ def Mesh "v" {{ {SQUARE} }} }} "large" (a = 1) {{ }} }}
    def Mesh "left" (displayName = "left \"one\"")
    {{
        {SQUARE}
        uniform token subdivisionScheme = "none"
        bool doubleSided = 0
        color3f[] primvars:displayColor = [(1, 0, 0)]
        texCoord2f[] primvars:map1 = [(0, 0), (1, 0), (1, 1), (0, 1)] (
            interpolation = "faceVarying"
        )
        custom string userProperties:a = 'b'; int c = 5
    }}
    def Mesh "right"
    {{
        {SQUARE}
        uniform token subdivisionScheme = "none"
        uniform token orientation = "leftHanded"
        float3 xformOp:scale = (2, 2, 2)
        double3 xformOp:translate:pivot = (1, 0, 0)
        uniform token[] xformOpOrder = ["xformOp:translate:pivot", "xformOp:scale", "!invert!xformOp:translate:pivot"]
        texCoord2f[] primvars:st = [(0, 0), (0.5, 0.5)] (interpolation = "vertex")
        int[] primvars:st:indices = [0, 1, 0, 1]
        def GeomSubset "part"
        {{
            uniform token elementType = "face"
            int[] indices = [0]
            rel material:binding = </Looks/Blue>
        }}
    }}
    def Mesh "hidden" {{ token visibility = "invisible" {SQUARE} }}
    def Mesh "off" (active = false) {{ {SQUARE} }}
    def Sphere "ball" {{ double radius = 2 }}
    def "Far" (references = [@far.usda@</Far> (offset = 1), @@@near@.usda@@@]) {{ }}
}}
def Scope "Looks"
{{
    def Material "Red"
    {{
        token outputs:surface.connect = </Looks/Red/Surface.outputs:surface>
        def Shader "Surface"
        {{
            uniform token info:id = "UsdPreviewSurface"
            color3f inputs:diffuseColor = (1, 0, 0)
            float inputs:opacity = 0.5
            float inputs:roughness = 0.25
            float inputs:metallic.connect = </Looks/Red/Texture.outputs:r>
        }}
    }}
    def Material "Blue" {{ }}
}}
"#
    )
}

#[test]
fn names_have_the_escapes_of_usd() {
    let names = [
        (r"a\n\tb", "a\n\tb"),
        (r#"\"a\'"#, "\"a'"),
        (r"\\n", r"\n"),
        (r"\x41\x4a2\x", "AJ2\0"),
        (r"\101\0602", "A02"),
        (r"caf\xc3\xa9", "caf\u{e9}"),
        (r"\303\251", "\u{e9}"),
        ("\u{e9}\u{4e16}", "\u{e9}\u{4e16}"),
        (r"\xff", "\u{fffd}"),
        (r"\u00e9\q", "u00e9q"),
    ];
    for (literal, name) in names {
        let first = format!("def Mesh \"a\" (displayName = \"{literal}\") {{ {SQUARE} }}");
        let found = mesh("usda", &layer("", &format!("{first}\ndef Mesh \"b\" {{ {SQUARE} }}")));
        assert_eq!(found.groups[0].name, name, "{literal}");
    }
}

#[test]
fn prims_stand_where_their_transforms_put_them() {
    let found = mesh("usda", scene().as_bytes());
    assert_eq!((found.unit, found.up), (Some(Unit::Millimetre), Some(Up::Z)));
    // rotated by a quarter turn about z, then translated
    let left = [[10.0, 0.0, 0.0], [10.0, 1.0, 0.0], [9.0, 1.0, 0.0], [9.0, 0.0, 0.0]];
    // doubled from (1, 0) before: (-1, 0), (1, 0), (1, 2), (-1, 2)
    let right = [[10.0, -1.0, 0.0], [10.0, 1.0, 0.0], [8.0, 1.0, 0.0], [8.0, -1.0, 0.0]];
    assert_eq!(found.positions, [left, right].concat());
    assert_eq!([found.faces.face(0), found.faces.face(1)], [&[0, 1, 2, 3], &[4, 7, 6, 5]]);
    assert_eq!(found.faces.len(), 2, "what is not shown is not there");
    assert_eq!(found.boundary, None, "polygons have no rule");
    let groups: Vec<_> = found.groups.iter().map(|set| (set.name.as_str(), set.faces.as_slice())).collect();
    assert_eq!(groups, [("left \"one\"", &[0][..]), ("right", &[1])]);
    let materials: Vec<_> = found.materials.iter().map(|set| (set.name.as_str(), set.faces.as_slice())).collect();
    assert_eq!(materials, [("Red", &[0][..]), ("Blue", &[1])]);
    let red = &found.looks[0];
    assert_eq!(red.color, Some([1.0, 0.0, 0.0, 0.5]));
    assert_eq!((red.roughness, red.metallic, red.double_sided), (Some(0.25), None, Some(false)));
    let uvs = found.uvs.as_ref().expect("both have texture coordinates");
    let at_corners: Vec<_> = uvs.corners.iter().map(|&row| uvs.values[row as usize]).collect();
    let left = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
    // the face is reversed: its corners are 0, 3, 2, 1
    assert_eq!(at_corners, [left, [[0.0, 0.0], [0.5, 0.5], [0.0, 0.0], [0.5, 0.5]]].concat());
    let color = &found.channels[0];
    assert_eq!((color.name.as_str(), color.width), ("color", 3));
    let white_where_nothing_is_said = [[1.0, 0.0, 0.0].repeat(4), [1.0; 12].to_vec()].concat();
    assert_eq!(color.values, white_where_nothing_is_said);
    let told = [
        "prims that are not shown are left out: 1",
        "prims that move are where they begin: 1",
        "references to other prims are left out: 1",
        "sets of variants are left out: 1",
        "shapes that are no meshes are left out: 1",
        "textures are left out: 1",
    ];
    assert_eq!(found.notes, told);
}

#[test]
fn cages_come_back_with_all_that_subdivision_needs() {
    let mut given = nets::grid(3, 3).to_json();
    given["creases"] = json!([{ "edge": [5, 6], "sharpness": 2.5 }, { "edge": [9, 10], "sharpness": 10 }]);
    given["corners"] = json!([{ "vertex": 0, "sharpness": 10 }, { "vertex": 5, "sharpness": 0.5 }]);
    given["holes"] = json!([4]);
    let values: Vec<[f64; 2]> = (0..16_u32).map(|i| [f64::from(i % 4) / 3.0, f64::from(i / 4) / 7.0]).collect();
    for boundary in ["edge-and-corner", "edge-only", "none"] {
        for interpolation in ["none", "corners-only", "corners-plus1", "corners-plus2", "boundaries", "all"] {
            given["uvs"] = json!({ "values": values, "faces": given["faces"], "interpolation": interpolation });
            let plan = json!({ "preset": "catmull-clark", "boundary": boundary });
            let job = |input: Value, levels: u32, format: &str| {
                let job = json!({
                    "input": input, "plan": plan, "levels": levels, "outputs": [{ "format": format }]
                });
                render(&job).unwrap_or_else(|faults| panic!("{faults:?} for {job}")).0
            };
            let cage = job(json!({ "mesh": given }), 0, "usda");
            let data = String::from_utf8(cage).expect("usda is text");
            let text = json!({ "text": { "format": "usda", "data": data } });
            let context = format!("{boundary} {interpolation}");
            assert_eq!(job(text, 2, "json"), job(json!({ "mesh": given }), 2, "json"), "{context}");
        }
    }
}

#[test]
fn the_rules_of_files_are_those_of_usd_where_they_say_nothing() {
    let found = mesh("usda", &square(""));
    assert_eq!(
        (found.unit, found.up, found.boundary),
        (Some(Unit::Centimetre), Some(Up::Y), Some(Boundary::EdgeAndCorner))
    );
    let uvs = "texCoord2f[] primvars:st = [(0, 0), (1, 0), (1, 1), (0, 1)] (interpolation = \"faceVarying\")";
    let word = |more: &str| mesh("usda", &square(&format!("{uvs} {more}"))).uvs.map(|uvs| uvs.interpolation);
    assert_eq!(word(""), Some(Interpolation::CornersPlus1));
    assert_eq!(word("token faceVaryingLinearInterpolation = \"boundaries\""), Some(Interpolation::Boundaries));
    assert_eq!(word("token subdivisionScheme = \"none\""), Some(Interpolation::All));
    let feet = mesh("usda", &layer("metersPerUnit = 0.3048", &format!("def Mesh \"a\" {{ {SQUARE} }}")));
    assert_eq!((feet.unit, feet.positions[1]), (Some(Unit::Metre), [0.3048, 0.0, 0.0]));
    assert_eq!(feet.notes, ["lengths are in metres, as their unit has no name here: 1"]);
}

#[test]
fn creases_have_a_sharpness_each_or_one_for_each_edge() {
    let chain = "int[] creaseIndices = [0, 1, 2, 3, 0] int[] creaseLengths = [3, 2] float[] creaseSharpnesses = ";
    let edges = [[0, 1], [1, 2], [3, 0]];
    for (sharpness, expected) in [("[2, 3.5]", [2.0, 2.0, 3.5]), ("[2, 3, inf]", [2.0, 3.0, f64::INFINITY])] {
        let found = mesh("usda", &square(&format!("{chain}{sharpness}")));
        assert_eq!(found.creases, edges.into_iter().zip(expected).collect::<Vec<_>>());
    }
    let found = sentences("usda", &square(&format!("{chain}[1, 2, 3, 4]")));
    assert!(found[0].contains("one for each of 2 creases or of 3 edges"), "{found:?}");
}

#[test]
fn primvars_are_channels_where_they_lie_on_vertices_or_corners() {
    let more = "float[] primvars:heat = [0, 1, 2, 3] (interpolation = \"vertex\")\n\
                double2[] primvars:pair = [(0, 1), (2, 3)] (interpolation = \"faceVarying\")\n\
                int[] primvars:pair:indices = [0, 1, 1, 0]\n\
                float[] primvars:even = [1, 2, 3, 4] (interpolation = \"varying\")\n\
                color3f[] primvars:displayColor = [(0, 0, 0)] (interpolation = \"uniform\")\n\
                float[] primvars:displayOpacity = [0.25]\n\
                string primvars:name = \"x\"\n\
                float primvars:whole = 5\n\
                float[] primvars:short = [1, 2] (interpolation = \"vertex\")\n";
    let found = mesh("usda", &square(more));
    let names: Vec<_> = found.channels.iter().map(|channel| (channel.name.as_str(), channel.width)).collect();
    assert_eq!(names, [("color", 4), ("even", 1), ("heat", 1), ("pair", 2)]);
    let word = |i: usize| found.channels[i].seams.as_ref().map(|seams| seams.interpolation);
    assert_eq!(
        [0, 1, 2, 3].map(word),
        [Some(Interpolation::CornersPlus1), Some(Interpolation::All), None, Some(Interpolation::CornersPlus1),]
    );
    assert_eq!(found.channels[0].values, [0.0, 0.0, 0.0, 0.25]);
    assert_eq!(found.channels[2].values, [0.0, 1.0, 2.0, 3.0]);
    let pair = found.channels[3].seams.as_ref().expect("it lies on corners");
    assert_eq!((pair.faces.face(0), &found.channels[3].values[..]), (&[0, 1, 1, 0][..], &[0.0, 1.0, 2.0, 3.0][..]));
    assert_eq!(found.notes.len(), 3, "{:?}", found.notes);
    for (name, why) in [("name", "its type is string"), ("whole", "constant"), ("short", "it has 2 values")] {
        assert!(found.notes.iter().any(|note| note.contains(name) && note.contains(why)), "{name}: {:?}", found.notes);
    }
}

#[test]
fn what_is_broken_is_refused_by_line_or_path() {
    let cases: [(Vec<u8>, &str); 16] = [
        (b"PXR-USDC".to_vec(), "does not begin with #usda"),
        (layer("", "def Mesh \"a\" {"), "line 3: the end stands where a property, a prim or } should"),
        (layer("", "\ndefine"), "line 4: \"define\" stands where def, over or class should"),
        (layer("", "def Mesh \"a"), "a text without its closing quotes"),
        (layer("", "/* a"), "a comment without an end"),
        (layer("", "def \"a\" { rel b = <c }"), "< without > behind it"),
        (layer("", "def \"a\" { int b = 1x }"), "\"1x\" is no number"),
        (layer("upAxis = \"X\"", ""), "upAxis is \"X\""),
        (layer("metersPerUnit = 0", ""), "metersPerUnit is no length above 0"),
        (square("int[] holeIndices = [1]"), "</a>: holeIndices: 1 is no whole number below 1"),
        (square("int[] cornerIndices = [4] float[] cornerSharpnesses = [1]"), "cornerIndices: 4 is no whole number"),
        (square("int[] cornerIndices = [3] float[] cornerSharpnesses = [-1]"), "-1 is no sharpness"),
        (square("token interpolateBoundary = \"x\""), "interpolateBoundary is \"x\""),
        (square("token[] xformOpOrder = [\"xformOp:twist\"]"), "\"xformOp:twist\" of its transform with 0 numbers"),
        (layer("", "def Mesh \"a\" { point3f[] points = [(1, 2)] }"), "no multiple of 3"),
        (
            layer("", "def Mesh \"a\" { int[] faceVertexCounts = [4] int[] faceVertexIndices = [0, 0, 0] }"),
            "faceVertexCounts, 0: 4 indices of 3 that are left",
        ),
    ];
    for (bytes, expected) in cases {
        let found = sentences("usda", &bytes);
        assert!(found[0].contains(expected), "{expected}: {found:?}");
    }
}

#[test]
fn what_is_deep_or_much_is_refused() {
    let deep = format!("{}{}", "def \"a\" {".repeat(100_000), "}".repeat(100_000));
    assert!(sentences("usda", &layer("", &deep))[0].contains("deeper in each other than 64"));
    let lists = format!("def \"a\" {{ int[] b = {} }}", "[".repeat(100_000));
    assert!(sentences("usda", &layer("", &lists))[0].contains("lists lie deeper in each other than 8"));
    let braces = format!("def \"a\" {{ dictionary b = {}", "{".repeat(100_000));
    assert!(sentences("usda", &layer("", &braces))[0].contains("the end stands where } should"));
    // many prims and properties of few bytes
    let prims = "def\"\"{int a}".repeat(200_000);
    assert!(sentences("usda", &layer("", &prims))[0].contains("send less at once"));
    let read = |max_vertices, max_faces| {
        (named("usda").expect("the reader exists").read)(
            &square("")[..].into(),
            &ReadLimits { max_vertices, max_faces },
        )
    };
    assert!(read(4, 1).is_ok());
    assert!(read(3, 1).expect_err("it is refused")[0].contains("4 vertices or more; 3 are allowed"));
    assert!(read(4, 0).expect_err("it is refused")[0].contains("1 faces or more; 0 are allowed"));
}

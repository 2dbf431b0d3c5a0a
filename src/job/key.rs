//! Keys: what of a job enters them, and how they are written. Whatever has a field that is not hashed says so here, as
//! it is taken apart exhaustively; enums enter by their names.

use std::fmt;

use super::codec::Item;
use super::input::Input;
use super::output::Output;
use crate::math::expression::{Expression, Instruction};
use crate::math::parameter::{Value, Values};
use crate::output::{LIMIT, TANGENTS};
use crate::scheme::letter::Letter;
use crate::scheme::operator::Role;
use crate::scheme::plan::{Latitude, Perturbation, Plan};
use crate::scheme::rules::{Rules, TriangleRule};
use crate::scheme::sharpness::Creasing;
use crate::scheme::word::Word;
use crate::shape::attachments::{Attachments, Channel};
use crate::shape::attributes::Attributes;
use crate::shape::creases::{INFINITE_SHARPNESS, Sharp};
use crate::shape::directions::Direction;
use crate::shape::frame::Frame;
use crate::shape::labels::Labels;
use crate::shape::mesh::Mesh;
use crate::shape::polygon::Polygon;
use crate::shape::repairs::{Faces, Repair};
use crate::shape::tile::Tile;
use crate::shape::topology::{Topology, index};
use crate::shape::uvs::Uvs;

/// Version of the results: raised whenever any artifact's bytes change.
pub const RESULTS_VERSION: u32 = 8;

/// Identity of an artifact, a job or a content: a BLAKE3 hash, written as 64 lowercase hexadecimal digits.
#[derive(Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Key([u8; 32]);

impl Key {
    /// The first of all keys in their order.
    pub const LEAST: Self = Self([0; 32]);

    /// The key with these bytes.
    pub const fn from_bytes(bytes: [u8; 32]) -> Self {
        Self(bytes)
    }

    /// The 32 bytes of the key.
    pub const fn as_bytes(&self) -> &[u8; 32] {
        &self.0
    }

    /// Reads 64 lowercase hexadecimal digits; anything else is no key.
    pub fn parse(text: &str) -> Option<Self> {
        let is_written = text.bytes().all(|digit| matches!(digit, b'0'..=b'9' | b'a'..=b'f'));
        let mut bytes = [0; 32];
        hex::decode_to_slice(text, &mut bytes).ok().filter(|()| is_written).map(|()| Self(bytes))
    }
}

impl fmt::Display for Key {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&hex::encode(self.0))
    }
}

impl fmt::Debug for Key {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{self}")
    }
}

/// Key of the bytes themselves.
pub fn content(bytes: &[u8]) -> Key {
    Key(*blake3::hash(bytes).as_bytes())
}

/// Keys of the outputs of a job: over the results version, the shape, the plan as far as it matters, the levels, and
/// the output's format and options. Names of outputs, and the words in which the job was written, are not part of them.
/// The shape is hashed once for all outputs.
pub(super) fn artifacts(shape: &Input, refined: &Plan, levels: u32, frame: Frame, outputs: &[Output]) -> Vec<Key> {
    let Frame { unit, up } = frame;
    let shape_key = hashed(&input(shape, refined)).to_string();
    let artifact = |output: &Output| {
        // the name is the client's affair, and so is the place among the outputs
        let Output { name: _, format, options, index: _ } = output;
        let mut items = vec![
            text("planish artifact"),
            Item::Integer(u64::from(RESULTS_VERSION)),
            text(&shape_key),
            plan(shape, refined, levels, shows_limit(output)),
            text(format.name()),
            values(options),
        ];
        if !frame.is_default() {
            items.push(Item::List(vec![text(unit.name()), text(up.name())]));
        }
        hashed(&Item::List(items))
    };
    outputs.iter().map(artifact).collect()
}

fn hashed(item: &Item<'_>) -> Key {
    let mut bytes = Vec::new();
    item.encode(&mut bytes);
    content(&bytes)
}

/// Key of a job: over the names and keys of its outputs, in order.
pub(super) fn job<'a>(outputs: impl Iterator<Item = (&'a str, &'a Key)>) -> Key {
    let entry = |(name, key): (&str, &Key)| Item::List(vec![text(name), text(&key.to_string())]);
    hashed(&Item::List(vec![text("planish job"), Item::List(outputs.map(entry).collect())]))
}

/// Key of a search for the level of a tolerance: over the results version, the shape, the whole plan, the tolerance and
/// where outputs have their points. Searches with the same key have the same answer.
pub(super) fn search(shape: &Input, refined: &Plan, tolerance: f64, places: &[&str]) -> Key {
    let items = vec![
        text("planish search"),
        Item::Integer(u64::from(RESULTS_VERSION)),
        input(shape, refined),
        plan(shape, refined, 1, true),
        // plans that no operator perturbs are refused, too
        Item::Integer(u64::from(refined.perturbation.is_some())),
        Item::Number(tolerance),
        Item::List(places.iter().map(|place| text(place)).collect()),
    ];
    hashed(&Item::List(items))
}

fn text(text: &str) -> Item<'static> {
    Item::Text(text.to_owned().into())
}

fn input<'a>(input: &'a Input, plan: &Plan) -> Item<'a> {
    match input {
        Input::Polygons(polygons) => {
            Item::List(vec![text("polygons"), Item::List(polygons.iter().map(polygon).collect())])
        }
        Input::Mesh(mesh) => self::mesh(mesh, plan),
    }
}

fn mesh<'a>(mesh: &'a Mesh, plan: &Plan) -> Item<'a> {
    let Mesh {
        positions,
        topology,
        corners,
        semi_sharp_corners,
        creases,
        holes,
        attributes,
        directions,
        attachments,
        // follows from the other vertices and the repairs
        split_from: _,
        repairs,
    } = mesh;
    let mut items = vec![
        text("mesh"),
        Item::Numbers(positions.into()),
        faces(topology),
        Item::Indices(corners.into()),
        Item::Indices(holes.into()),
        // repairs are reported with the result, so that they belong to it
        Item::List(repairs.iter().map(repair).collect()),
    ];
    items.extend(sharp("creases", creases));
    items.extend(sharp("semi-sharp corners", semi_sharp_corners));
    items.extend(self::attachments(attachments, !creases.is_empty()));
    items.extend(directions.as_ref().filter(|_| plan.latitude.is_some()).map(|lines| {
        let edges = |direction| Item::Indices(lines.edges(direction).into());
        Item::List(vec![text("lines"), edges(Direction::Latitude), edges(Direction::Longitude)])
    }));
    items.extend(attributes.as_ref().map(|kept| Item::List(self::attributes(kept))));
    Item::List(items)
}

/// A repair by its kind and its numbers, whatever the sentence that tells of it.
fn repair(repair: &Repair) -> Item<'_> {
    let count = |n: usize| Item::Integer(n as u64);
    let some = |Faces { count, first }: &Faces| [Item::Integer(*count as u64), Item::Indices(first.clone().into())];
    Item::List(match repair {
        Repair::Read(note) => vec![text("read"), text(note)],
        Repair::Welded { merged, pairs } => {
            vec![text("welded"), count(*merged), Item::Indices(pairs.concat().into())]
        }
        Repair::LostParameters(lost) => {
            let one =
                |(name, [from, into]): &(&str, [usize; 2])| Item::List(vec![text(name), count(*from), count(*into)]);
            [text("lost parameters")].into_iter().chain(lost.iter().map(one)).collect()
        }
        Repair::LeftOut(faces) => [text("left out")].into_iter().chain(some(faces)).collect(),
        Repair::Turned(faces) => [text("turned")].into_iter().chain(some(faces)).collect(),
        Repair::Paired { pairs, left } => vec![text("paired"), count(*pairs), count(*left)],
        Repair::Split { from, added } => vec![text("split"), Item::Integer(u64::from(*from)), count(*added)],
    })
}

/// What a mesh carries, where there is any: a list for each kind that is given. Pairs of places count beside creases.
fn attachments(attachments: &Attachments, creased: bool) -> Option<Item<'_>> {
    let Attachments { channels, groups, materials, uvs } = attachments;
    let mut kinds = Vec::new();
    if !channels.is_empty() {
        kinds.push(text("channels"));
        kinds.extend(channels.iter().map(|Channel { name, width, values }| {
            Item::List(vec![text(name), Item::Integer(*width as u64), Item::Numbers(values.into())])
        }));
    }
    for (kind, labels) in [("groups", groups), ("materials", materials)] {
        if !labels.is_empty() {
            let Labels { names, of_faces } = labels;
            let names = names.iter().map(|name| text(name)).collect();
            kinds.push(Item::List(vec![text(kind), Item::List(names), Item::Indices(of_faces.into())]));
        }
    }
    if let Some(Uvs { values, topology, corners, pairs, linear }) = uvs {
        let linear = Item::Integer(u64::from(*linear));
        let corners = Item::Indices(corners.into());
        let mut items = vec![text("uvs"), linear, corners, faces(topology), Item::Numbers(values.into())];
        if creased && !pairs.is_empty() {
            items.push(Item::Indices(pairs.concat().into()));
        }
        kinds.push(Item::List(items));
    }
    (!kinds.is_empty()).then_some(Item::List(kinds))
}

/// What is sharp, if anything is.
fn sharp(name: &str, sharp: &Sharp) -> Option<Item<'static>> {
    let (indices, values): (Vec<u32>, Vec<f64>) = sharp.iter().copied().unzip();
    let item = || Item::List(vec![text(name), Item::Indices(indices.into()), Item::Numbers(values.into())]);
    (!sharp.is_empty()).then(item)
}

fn polygon(polygon: &Polygon) -> Item<'_> {
    let Polygon { points, dimension, closed, corners, rational, tangents, pinned, attributes } = polygon;
    let mut items = vec![
        Item::Integer(*dimension as u64),
        Item::Integer(u64::from(*closed)),
        Item::Integer(u64::from(*rational)),
        Item::List(attributes.as_ref().map(self::attributes).unwrap_or_default()),
        Item::Numbers(points.into()),
        Item::Indices(corners.into()),
    ];
    items.extend(tangents.as_ref().map(|tangents| Item::Numbers(tangents.into())));
    if !pinned.is_empty() {
        items.push(Item::Indices(pinned.into()));
    }
    Item::List(items)
}

fn attributes(attributes: &Attributes) -> Vec<Item<'_>> {
    let Attributes { alpha, kernel, compensation, delta } = attributes;
    let arrays = [("alpha", alpha), ("kernel", kernel), ("compensation", compensation), ("delta", delta)];
    let given = arrays.into_iter().filter_map(|(name, array)| Some((name, array.as_ref()?)));
    given.map(|(name, array)| Item::List(vec![text(name), Item::Numbers(array.into())])).collect()
}

fn faces(topology: &Topology) -> Item<'static> {
    let sizes: Vec<u32> = (0..topology.n_faces()).map(|f| index(topology.face(f).len())).collect();
    let vertices: Vec<u32> = (0..topology.n_faces()).flat_map(|f| topology.face(f)).copied().collect();
    Item::List(vec![Item::Indices(sizes.into()), Item::Indices(vertices.into())])
}

/// Whether an output shows the limit, which is that of the plan even where none of its levels was applied.
fn shows_limit(output: &Output) -> bool {
    let of_limit = |(name, value): (&str, &Value)| name == TANGENTS.name || *value == Value::Choice(LIMIT);
    output.options.unusual().any(of_limit)
}

/// Everything of a plan that can change the result, which shows so many levels or also the limit: what no operator uses
/// is left out.
fn plan(input: &Input, refined: &Plan, levels: u32, shows_limit: bool) -> Item<'static> {
    let Plan {
        word: Word { prefix, cycle },
        alpha,
        compensation_alpha,
        kernel,
        mu,
        compensation,
        delta,
        boundary,
        rules,
        ends,
        perturbation,
        latitude,
    } = refined;
    let letters = |letters: &[Letter]| {
        let letter = |letter: &Letter| {
            let Letter { operator, settings } = letter;
            Item::List(vec![text(operator.facts().name), values(settings.values())])
        };
        Item::List(letters.iter().map(letter).collect())
    };
    let cycle: &[Letter] = if levels == 0 && !shows_limit { &[] } else { cycle };
    let has = |role: Role| prefix.iter().chain(cycle).any(|l| l.facts().role == role);
    let mut functions = Vec::new();
    if has(Role::Average) {
        functions.push(("kernel", Item::List(kernel.iter().map(expression).collect())));
    }
    let averages = |l: &Letter| l.settings.tile() == Tile::Triangle && l.facts().uses.contains(&"mu");
    if prefix.iter().chain(cycle).any(averages) {
        functions.push(("mu", Item::Number(*mu)));
    }
    if has(Role::PushBack) {
        functions.push(("compensation", expression(compensation)));
        functions.push(("delta", expression(delta)));
    }
    let follows = |l: &Letter| l.facts().needs_alpha;
    let compensated = has(Role::PushBack) && !compensation.is_constant();
    let other = compensation_alpha.filter(|_| compensated);
    let in_alpha = has(Role::Average) && kernel.iter().any(|k| !k.is_constant())
        || compensated && other.is_none()
        || prefix.iter().chain(cycle).any(follows);
    if in_alpha {
        functions.push(("alpha", Item::Number(*alpha)));
    }
    functions.extend(other.map(|other| ("compensation_alpha", Item::Number(other))));
    if let Some(perturbation) = perturbation.filter(|_| has(Role::Average) || has(Role::PushBack)) {
        let Perturbation { amplitude, decay, seed } = perturbation;
        let numbers = Item::Numbers(vec![amplitude, decay].into());
        functions.push(("perturbation", Item::List(vec![numbers, Item::Integer(seed)])));
    }
    if let Some(Latitude { rule, kernel_longitude, own_alpha }) = latitude {
        let head = [text(rule.name()), Item::Integer(u64::from(*own_alpha))];
        functions.push((
            "latitude",
            Item::List(head.into_iter().chain(kernel_longitude.as_ref().map(expression)).collect()),
        ));
    }
    if levels > 0 || shows_limit {
        functions.extend(self::rules(input, *rules));
    }
    let (is_mesh, is_open) = input.kind();
    if is_open && is_mesh {
        functions.push(("boundary", text(boundary.name())));
    } else if is_open {
        functions.push(("ends", text(ends.name())));
    }
    let functions = functions.into_iter().map(|(name, item)| Item::List(vec![text(name), item])).collect();
    Item::List(vec![letters(prefix), letters(cycle), Item::Integer(u64::from(levels)), Item::List(functions)])
}

/// The rules of meshes that are not the usual ones, as far as the mesh gives them something to do.
fn rules(input: &Input, rules: Rules) -> Vec<(&'static str, Item<'static>)> {
    let Rules { creasing, triangles } = rules;
    let Input::Mesh(mesh) = input else { return Vec::new() };
    let semi_sharp = || mesh.creases.iter().any(|&(_, sharpness)| sharpness < INFINITE_SHARPNESS);
    let has_triangle = || (0..mesh.topology.n_faces()).any(|f| mesh.topology.face(f).len() == 3);
    let mut said = Vec::new();
    if creasing != Creasing::default() && semi_sharp() {
        said.push(("creasing", text(creasing.name())));
    }
    if triangles != TriangleRule::default() && has_triangle() {
        said.push(("triangles", text(triangles.name())));
    }
    said
}

fn expression(expression: &Expression) -> Item<'static> {
    let instruction = |instruction: &Instruction| match instruction {
        Instruction::Constant(x) => Item::Number(*x),
        Instruction::Variable => text("variable"),
        Instruction::Unary(op) => Item::List(vec![text("unary"), text(op.name())]),
        Instruction::Binary(op) => Item::List(vec![text("binary"), text(op.name())]),
    };
    Item::List(expression.code().iter().map(instruction).collect())
}

/// Options as they are written or left out makes no difference, so that new ones leave old keys alone.
fn values(values: &Values) -> Item<'static> {
    let entry = |(name, value)| Item::List(vec![text(name), self::value(value)]);
    Item::List(values.unusual().map(entry).collect())
}

fn value(value: &Value) -> Item<'static> {
    match value {
        Value::Absent => text("absent"),
        Value::Number(x) => Item::Number(*x),
        Value::Integer(x) => Item::Integer(x.cast_unsigned()),
        Value::Flag(x) => Item::Integer(u64::from(*x)),
        Value::Choice(x) => text(x),
        Value::Name(x) => text(x),
        Value::Choices(xs) => Item::List(xs.iter().map(|x| text(x)).collect()),
        Value::Expression(x) => expression(x),
        Value::Expressions(xs) => Item::List(xs.iter().map(expression).collect()),
        Value::Numbers(x) => Item::Numbers(x.clone().into()),
        Value::Color(x) => Item::Integer(u64::from(u32::from_le_bytes(*x))),
        Value::Vector(x) => Item::Numbers(x.to_vec().into()),
        Value::Group(x) => values(x),
        Value::Groups(xs) => Item::List(xs.iter().map(values).collect()),
    }
}

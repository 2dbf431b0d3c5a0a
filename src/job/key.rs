//! The keys of results: which parts of a job enter them, and how they are written. Fields that are not hashed are named
//! here, since all types are destructured exhaustively; enums enter by their names.

use std::fmt;

use super::codec::Item;
use super::input::Input;
use super::output::Output;
use super::shape_items::{connectivity, input, lines, mesh};
use crate::analysis::smoothness::Symbol;
use crate::analysis::{LevelMask, Study};
use crate::math::expression::{Expression, Instruction};
use crate::math::mask::Mask;
use crate::math::parameter::{Value, Values};
use crate::output::figure::{PanelCell, PanelGrid};
use crate::output::{LIMIT, TANGENTS, shows_distances, surface};
use crate::scheme::letter::Letter;
use crate::scheme::operator::Role;
use crate::scheme::plan::{Latitude, Perturbation, Plan};
use crate::scheme::rules::{Rules, TriangleRule};
use crate::scheme::sharpness::Creasing;
use crate::scheme::word::Word;
use crate::shape::coordinate_system::CoordinateSystem;
use crate::shape::creases::INFINITE_SHARPNESS;
use crate::shape::tile::Tile;

/// The version of the results, raised whenever the bytes of any artifact change.
pub const RESULTS_VERSION: u32 = 19;

/// Identity of an artifact, a job or a content: a BLAKE3 hash, written as 64 lowercase hexadecimal digits.
#[derive(Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Key([u8; 32]);

impl Key {
    /// The least key in their order.
    pub const LEAST: Self = Self([0; 32]);

    /// Creates the key with these bytes.
    pub const fn from_bytes(bytes: [u8; 32]) -> Self {
        Self(bytes)
    }

    /// Returns the 32 bytes of the key.
    pub const fn as_bytes(&self) -> &[u8; 32] {
        &self.0
    }

    /// Parses 64 lowercase hexadecimal digits; returns `None` for anything else.
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

/// Returns the key of the bytes themselves.
pub fn content(bytes: &[u8]) -> Key {
    Key(*blake3::hash(bytes).as_bytes())
}

/// Returns the keys of the outputs of a job: over the results version, the shape, the used part of the plan, the
/// levels, and the format and options of the output. Names of outputs, and the spelling of the job, do not enter. The
/// shape is hashed once for all outputs. Each artifact's key comes with the key of the refined shape that it shows.
/// Pictures of distances from the surface of another job include the key of that surface.
pub(super) fn artifacts(
    (shape, coordinate_system): (&Input, CoordinateSystem),
    (refined, levels): (&Plan, u32),
    outputs: &[Output],
    other: Option<Key>,
) -> (Vec<Key>, Vec<Key>) {
    let CoordinateSystem { unit, up } = coordinate_system;
    let whole = hashed(&input(shape, refined));
    let artifact = |output: &Output| {
        // the name, and the position among the outputs, are the client's choice
        let Output { name: _, format, options, frame: shown, description, index: _ } = output;
        let shape_key = match (shape.mesh(), shown) {
            // the same key as for a mesh with these positions alone
            (Some(alone), Some(_)) if !alone.frames.is_empty() => hashed(&mesh(&alone.at_frame(*shown), refined)),
            _ => whole,
        };
        let head = |name| {
            let version = Item::Integer(u64::from(RESULTS_VERSION));
            let plan = plan(shape, refined, levels, shows_limit(output));
            vec![Item::text(name), version, Item::text(&shape_key.to_string()), plan]
        };
        let mut items = head("planish artifact");
        items.extend([Item::text(format.name()), values(options)]);
        items.extend(shown_lines(shape, refined, options));
        if !coordinate_system.is_default() {
            items.push(Item::List(vec![Item::text(unit.name()), Item::text(up.name())]));
        }
        items.extend(described(description.as_deref()));
        items.extend(
            other
                .filter(|_| shows_distances(options))
                .map(|other| Item::List(vec![Item::text("distance to"), Item::text(&other.to_string())])),
        );
        let mut shown = head("planish refined shape");
        shown.extend(surface::limit(options).map(u64::from).map(Item::Integer));
        (hashed(&Item::List(items)), hashed(&Item::List(shown)))
    };
    outputs.iter().map(artifact).unzip()
}

/// Returns the key of a figure: over the keys of its panels at their sizes, the layout, and the output.
pub(super) fn figure(panels: impl Iterator<Item = Key>, (grid, one_scale): (&PanelGrid, bool), output: &Output) -> Key {
    let Output { name: _, format, options, frame: _, description, index: _ } = output;
    let PanelGrid { columns, title, letters, cells } = grid;
    let text = |text: &Option<String>| Item::List(text.iter().map(|text| Item::text(text)).collect());
    let mut panels = panels;
    let cell = |PanelCell { span, proportion: _, caption, layers }: &PanelCell| {
        // the proportion follows from the size, which is in the keys of the panels
        let mut items: Vec<Item<'_>> = panels.by_ref().take(*layers).map(|key| Item::text(&key.to_string())).collect();
        items.extend([Item::Indices(span.to_vec().into()), text(caption)]);
        Item::List(items)
    };
    let mut items = vec![
        Item::List(cells.iter().map(cell).collect()),
        Item::Integer(u64::from(*columns)),
        text(title),
        Item::Integer(u64::from(*letters)),
        Item::Integer(u64::from(one_scale)),
        Item::text(format.name()),
        values(options),
    ];
    items.extend(described(description.as_deref()));
    versioned("planish figure", items)
}

/// Returns the item of the description of the job in the bytes, if there is one.
fn described(description: Option<&str>) -> Option<Item<'static>> {
    description.map(|text| Item::List(vec![Item::text("description"), Item::text(text)]))
}

/// Returns the key of a moving picture: over the keys that its frames have as jobs.
pub(super) fn film(frames: impl Iterator<Item = Key>) -> Key {
    let frames = frames.map(|key| Item::text(&key.to_string())).collect();
    hashed(&Item::List(vec![Item::text("planish film"), Item::List(frames)]))
}

/// Returns the item of latitude and longitude lines, if a picture shows them and the plan does not use them.
fn shown_lines<'a>(shape: &'a Input, refined: &Plan, options: &Values) -> Option<Item<'a>> {
    let shown = crate::output::DIRECTION_ITEMS.iter().any(|direction| options.has("show", direction));
    let mesh = shape.mesh().filter(|_| shown && refined.latitude.is_none())?;
    mesh.directions.as_ref().map(lines)
}

/// Returns the key of the program by which a mesh is refined, independent of positions and channels: over its
/// connectivity, the tags, the plan and the levels. `None` if vertex parameters or edge directions matter.
pub(super) fn program(input: &Input, refined: &Plan, levels: u32) -> Option<Key> {
    let mesh = input.mesh().filter(|mesh| mesh.attributes.is_none() && mesh.directions.is_none())?;
    let plan = plan(input, refined, levels, false);
    Some(versioned("planish program", [connectivity(mesh), plan]))
}

pub(super) fn hashed(item: &Item<'_>) -> Key {
    let mut bytes = Vec::new();
    item.encode(&mut bytes);
    content(&bytes)
}

/// Returns the hash of a list of items that follow a name and the version of the results.
pub(super) fn versioned<'a>(name: &str, items: impl IntoIterator<Item = Item<'a>>) -> Key {
    let head = [Item::text(name), Item::Integer(u64::from(RESULTS_VERSION))];
    hashed(&Item::List(head.into_iter().chain(items).collect()))
}

/// Returns the key of a job: over the names and keys of its outputs, in order.
pub fn job<'a>(outputs: impl Iterator<Item = (&'a str, &'a Key)>) -> Key {
    let entry = |(name, key): (&str, &Key)| Item::List(vec![Item::text(name), Item::text(&key.to_string())]);
    hashed(&Item::List(vec![Item::text("planish job"), Item::List(outputs.map(entry).collect())]))
}

/// Returns the key of a search for the level of a tolerance: over the results version, the shape, the whole plan, the
/// tolerance and the places of the outputs' points. Searches with the same key have the same answer.
pub(super) fn search(shape: &Input, refined: &Plan, tolerance: f64, places: &[&str]) -> Key {
    let items = vec![
        input(shape, refined),
        plan(shape, refined, 1, true),
        // a plan with a perturbation is refused even if no operator uses it
        Item::Integer(u64::from(refined.perturbation.is_some())),
        Item::Number(tolerance),
        Item::List(places.iter().map(|place| Item::text(place)).collect()),
    ];
    versioned("planish search", items)
}

/// Returns the key of an analysis: over the results version, the masks (exact where known), the requested parts, and
/// polygons with their plan, if there are any.
pub(super) fn analysis(
    study: &Study,
    nodes: u64,
    grid: Option<u32>,
    matrices: Option<Item<'_>>,
    on: Option<(&Input, &Plan)>,
) -> Key {
    let Study { settled, levels } = study;
    // order and residual follow from the mask
    let Symbol { arity, first: _, mask: _, is_exact, order: _, residual: _, reach: [from, to] } = settled;
    let level = |level: &LevelMask| {
        // the other fields follow from these and the limit scheme
        let LevelMask { alpha, mask: Mask { first, values }, order: _, distance: _, keeps_circles: _ } = level;
        let first = Item::Integer(i64::from(*first).cast_unsigned());
        Item::List(vec![Item::Number(*alpha), first, Item::Numbers(values.clone().into())])
    };
    let mut items = vec![
        Item::Integer(arity.cast_unsigned()),
        Item::Integer(from.cast_unsigned()),
        Item::List((*from..=*to).map(|j| Item::text(&settled.at(j).to_string())).collect()),
        Item::Integer(u64::from(*is_exact)),
        Item::List(levels.iter().map(level).collect()),
        Item::Integer(nodes),
        Item::List(grid.iter().map(|grid| Item::Integer(u64::from(*grid))).collect()),
    ];
    items.extend(matrices);
    if let Some((shape, refined)) = on {
        items.extend([input(shape, refined), plan(shape, refined, 1, true)]);
    }
    versioned("planish analysis", items)
}

/// Returns the key of an analysis of a plan as a surface scheme: over the results version, the plan at alpha = 0
/// without what its operators do not use, the requested parts, and the mesh with its plan, if there is one.
pub(super) fn surface_analysis(
    settled: &Plan,
    follows_alpha: bool,
    [valences, boundaries]: [&[usize]; 2],
    nodes: u64,
    on: Option<(&Input, &Plan)>,
) -> Key {
    let numbers = |of: &[usize]| Item::List(of.iter().map(|&n| Item::Integer(n as u64)).collect());
    let mut items = vec![
        plan_of(settled, 1, true, [true, false], Vec::new()),
        Item::Integer(u64::from(follows_alpha)),
        numbers(valences),
        numbers(boundaries),
        Item::Integer(nodes),
    ];
    if let Some((shape, refined)) = on {
        items.extend([input(shape, refined), plan(shape, refined, 1, true)]);
    }
    versioned("planish surface analysis", items)
}

/// Returns whether an output shows the limit or names the scheme, so that the whole plan matters even at level 0.
fn shows_limit(output: &Output) -> bool {
    let of_limit = |(name, value): (&str, &Value)| name == TANGENTS.name || *value == Value::Choice(LIMIT);
    output.format.facts().tells_plan || output.options.unusual().any(of_limit)
}

/// Returns the item of everything in a plan that can change the result at `levels` levels, or the limit if that is
/// shown; functions that no operator uses are left out.
fn plan(input: &Input, refined: &Plan, levels: u32, shows_limit: bool) -> Item<'static> {
    let (is_mesh, is_open) = input.kind();
    plan_of(refined, levels, shows_limit, [is_mesh, is_open], rules(input, refined.rules))
}

/// Returns the item of a plan for a shape that is a mesh or not, open or not, under these rules of the scheme.
pub(super) fn plan_of(
    refined: &Plan,
    levels: u32,
    shows_limit: bool,
    [is_mesh, is_open]: [bool; 2],
    rules: Vec<(&'static str, Item<'static>)>,
) -> Item<'static> {
    let Plan {
        word: Word { prefix, cycle },
        alpha,
        compensation_alpha,
        kernel,
        mu,
        compensation,
        delta,
        boundary,
        // `rules` holds those that matter to the shape; they are passed separately
        rules: _,
        ends,
        perturbation,
        latitude,
    } = refined;
    let letters = |letters: &[Letter]| {
        let letter = |letter: &Letter| {
            let Letter { operator, settings } = letter;
            Item::List(vec![Item::text(operator.facts().name), values(settings.values())])
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
        let head = [Item::text(rule.name()), Item::Integer(u64::from(*own_alpha))];
        functions.push((
            "latitude",
            Item::List(head.into_iter().chain(kernel_longitude.as_ref().map(expression)).collect()),
        ));
    }
    if levels > 0 || shows_limit {
        functions.extend(rules);
    }
    if is_open && is_mesh {
        functions.push(("boundary", Item::text(boundary.name())));
    } else if is_open {
        functions.push(("ends", Item::text(ends.name())));
    }
    let functions = functions.into_iter().map(|(name, item)| Item::List(vec![Item::text(name), item])).collect();
    Item::List(vec![letters(prefix), letters(cycle), Item::Integer(u64::from(levels)), Item::List(functions)])
}

/// Returns the items of the rules of meshes that differ from the defaults and matter to the mesh.
fn rules(input: &Input, rules: Rules) -> Vec<(&'static str, Item<'static>)> {
    let Rules { creasing, triangles } = rules;
    let Input::Mesh(mesh) = input else { return Vec::new() };
    let semi_sharp = || mesh.creases.iter().any(|&(_, sharpness)| sharpness < INFINITE_SHARPNESS);
    let has_triangle = || (0..mesh.topology.n_faces()).any(|f| mesh.topology.face(f).len() == 3);
    let mut said = Vec::new();
    if creasing != Creasing::default() && semi_sharp() {
        said.push(("creasing", Item::text(creasing.name())));
    }
    if triangles != TriangleRule::default() && has_triangle() {
        said.push(("triangles", Item::text(triangles.name())));
    }
    said
}

fn expression(expression: &Expression) -> Item<'static> {
    let instruction = |instruction: &Instruction| match instruction {
        Instruction::Constant(x) => Item::Number(*x),
        Instruction::Variable => Item::text("variable"),
        Instruction::Unary(op) => Item::List(vec![Item::text("unary"), Item::text(op.name())]),
        Instruction::Binary(op) => Item::List(vec![Item::text("binary"), Item::text(op.name())]),
    };
    Item::List(expression.code().iter().map(instruction).collect())
}

/// Options with default values are left out, so that new options do not change old keys.
fn values(values: &Values) -> Item<'static> {
    let entry = |(name, value)| Item::List(vec![Item::text(name), self::value(value)]);
    Item::List(values.unusual().map(entry).collect())
}

fn value(value: &Value) -> Item<'static> {
    match value {
        Value::Absent => Item::text("absent"),
        Value::Number(x) => Item::Number(*x),
        Value::Integer(x) => Item::Integer(x.cast_unsigned()),
        Value::Flag(x) => Item::Integer(u64::from(*x)),
        Value::Choice(x) => Item::text(x),
        Value::Name(x) => Item::text(x),
        Value::Choices(xs) => Item::List(xs.iter().map(|x| Item::text(x)).collect()),
        Value::Expression(x) => expression(x),
        Value::Expressions(xs) => Item::List(xs.iter().map(expression).collect()),
        Value::Numbers(x) => Item::Numbers(x.clone().into()),
        Value::Color(x) => Item::Integer(u64::from(u32::from_le_bytes(*x))),
        Value::Vector(x) => Item::Numbers(x.to_vec().into()),
        Value::Group(x) => values(x),
        Value::Groups(xs) => Item::List(xs.iter().map(values).collect()),
    }
}

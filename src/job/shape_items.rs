//! The items of shapes for keys.

use super::codec::Item;
use super::input::Input;
use crate::scheme::plan::Plan;
use crate::shape::attachments::{Attachments, Channel, Places};
use crate::shape::attributes::Attributes;
use crate::shape::creases::Sharp;
use crate::shape::directions::{Direction, Directions};
use crate::shape::labels::Labels;
use crate::shape::looks::{Alpha, Look};
use crate::shape::mesh::Mesh;
use crate::shape::polygon::Polygon;
use crate::shape::repairs::{AffectedEdges, AffectedFaces, Repair};
use crate::shape::seams::{Seams, Uvs};
use crate::shape::textures::{Filter, Texture};
use crate::shape::topology::{Topology, index};

/// Returns the item of an input; the plan decides which parts matter.
pub(super) fn input<'a>(input: &'a Input, plan: &Plan) -> Item<'a> {
    match input {
        Input::Polygons(polygons) => {
            Item::List(vec![Item::text("polygons"), Item::List(polygons.iter().map(polygon).collect())])
        }
        Input::Mesh(mesh) => self::mesh(mesh, plan),
    }
}

/// Returns the item of a mesh.
pub(super) fn mesh<'a>(mesh: &'a Mesh, plan: &Plan) -> Item<'a> {
    let Mesh {
        positions,
        frames,
        topology,
        corners,
        semi_sharp_corners,
        creases,
        holes,
        attributes,
        directions,
        attachments,
        // `split_from` follows from the other vertices and the repairs
        split_from: _,
        repairs,
    } = mesh;
    let mut items = vec![
        Item::text("mesh"),
        Item::Numbers(positions.into()),
        faces(topology),
        Item::Indices(corners.into()),
        Item::Indices(holes.into()),
        // repairs are reported with the result and thus belong to it
        Item::List(repairs.iter().map(repair).collect()),
    ];
    if !frames.is_empty() {
        let frames = frames.iter().map(|frame| Item::Numbers(frame.into())).collect();
        items.push(Item::List(vec![Item::text("frames"), Item::List(frames)]));
    }
    items.extend(sharp("creases", creases));
    items.extend(sharp("semi-sharp corners", semi_sharp_corners));
    items.extend(self::attachments(attachments, topology.n_faces(), !creases.is_empty()));
    items.extend(directions.as_ref().filter(|_| plan.latitude.is_some()).map(lines));
    items.extend(attributes.as_ref().map(|kept| Item::List(self::attributes(kept))));
    Item::List(items)
}

/// Returns the item of latitude and longitude lines.
pub(super) fn lines(directions: &Directions) -> Item<'static> {
    let edges = |direction| Item::Indices(directions.edges(direction).into());
    Item::List(vec![Item::text("lines"), edges(Direction::Latitude), edges(Direction::Longitude)])
}

/// Returns the item of the connectivity and the tags of a mesh without vertex parameters and directions, including its
/// seams, but without any values of vertices.
pub(super) fn connectivity(mesh: &Mesh) -> Item<'_> {
    let count = |topology: &Topology| Item::Integer(topology.n_vertices() as u64);
    let mut items = vec![
        count(&mesh.topology),
        faces(&mesh.topology),
        Item::Indices((&mesh.corners).into()),
        Item::Indices((&mesh.holes).into()),
    ];
    items.extend(sharp("creases", &mesh.creases));
    items.extend(sharp("semi-sharp corners", &mesh.semi_sharp_corners));
    items.extend(mesh.attachments.places().enumerate().map(|(i, Places { values: _, width: _, seams })| {
        let Seams { topology, corners, pairs, linear } = seams;
        let [corners, pairs] = [corners.into(), pairs.concat().into()].map(Item::Indices);
        let linear = Item::Integer(u64::from(*linear));
        let is_uvs = i == 0 && mesh.attachments.uvs.is_some();
        let kind = Item::text(if is_uvs { "uvs" } else { "seams" });
        Item::List(vec![kind, linear, count(topology), faces(topology), corners, pairs])
    }));
    Item::List(items)
}

/// Returns the item of a repair: its kind and its numbers, independent of the message.
fn repair(repair: &Repair) -> Item<'_> {
    let count = |n: usize| Item::Integer(n as u64);
    let some = |AffectedFaces { count, first }: &AffectedFaces| {
        [Item::Integer(*count as u64), Item::Indices(first.clone().into())]
    };
    let edges_of = |kind, AffectedEdges { count: n, first }: &AffectedEdges| {
        vec![Item::text(kind), count(*n), Item::Indices(first.concat().into())]
    };
    Item::List(match repair {
        Repair::Read(note) => vec![Item::text("read"), Item::text(note)],
        Repair::Welded { merged, pairs } => {
            vec![Item::text("welded"), count(*merged), Item::Indices(pairs.concat().into())]
        }
        Repair::LostParameters(lost) => {
            let one = |(name, [from, into]): &(&str, [usize; 2])| {
                Item::List(vec![Item::text(name), count(*from), count(*into)])
            };
            [Item::text("lost parameters")].into_iter().chain(lost.iter().map(one)).collect()
        }
        Repair::LeftOut(faces) => [Item::text("left out")].into_iter().chain(some(faces)).collect(),
        Repair::Turned(faces) => [Item::text("turned")].into_iter().chain(some(faces)).collect(),
        Repair::Paired { pairs, left } => vec![Item::text("paired"), count(*pairs), count(*left)],
        Repair::Split { added, first } => {
            vec![Item::text("split"), count(*added), Item::Indices(first.concat().into())]
        }
        Repair::Crowded(edges) => edges_of("crowded", edges),
        Repair::Opposed(edges) => edges_of("opposed", edges),
        Repair::Doubled(edges) => edges_of("doubled", edges),
        Repair::Repeating(faces) => [Item::text("repeating")].into_iter().chain(some(faces)).collect(),
    })
}

/// Returns the item of the attachments, if there are any: a list for each kind. Pairs of places matter if there are
/// creases.
fn attachments(attachments: &Attachments, n_faces: usize, creased: bool) -> Option<Item<'_>> {
    // the topology of all seams follows from them
    let Attachments { channels, groups, materials, looks, uvs, unfolded: _ } = attachments;
    let mut kinds = Vec::new();
    if !channels.is_empty() {
        kinds.push(Item::text("channels"));
        kinds.extend(channels.iter().map(|Channel { name, width, values, seams }| {
            let mut items = vec![Item::text(name), Item::Integer(*width as u64), Item::Numbers(values.into())];
            items.extend(seams.iter().flat_map(|seams| self::seams(seams, creased)));
            Item::List(items)
        }));
    }
    for (kind, labels) in [("groups", groups), ("materials", materials)] {
        if !labels.is_empty() {
            let Labels { names, of_faces } = labels;
            let names = names.iter().map(|name| Item::text(name)).collect();
            let of_faces = if labels.differ() { of_faces.into() } else { vec![0; n_faces].into() };
            kinds.push(Item::List(vec![Item::text(kind), Item::List(names), Item::Indices(of_faces)]));
        }
    }
    if !looks.is_empty() {
        kinds.push(Item::List([Item::text("looks")].into_iter().chain(looks.iter().map(look)).collect()));
    }
    if let Some(Uvs { values, seams }) = uvs {
        let mut items = vec![Item::text("uvs")];
        items.extend(self::seams(seams, creased));
        items.insert(4, Item::Numbers(values.into()));
        kinds.push(Item::List(items));
    }
    (!kinds.is_empty()).then_some(Item::List(kinds))
}

/// Returns the three or four items of seams.
fn seams(Seams { topology, corners, pairs, linear }: &Seams, creased: bool) -> Vec<Item<'_>> {
    let linear = Item::Integer(u64::from(*linear));
    let mut items = vec![linear, Item::Indices(corners.into()), faces(topology)];
    if creased && !pairs.is_empty() {
        items.push(Item::Indices(pairs.concat().into()));
    }
    items
}

/// Returns the item of a material's appearance, with the bytes of its image.
fn look<'a>(look: &'a Look) -> Item<'a> {
    let Look { color, metallic, roughness, double_sided, alpha, texture } = look;
    let mut items = Vec::new();
    let mut said = |name, value: Option<Item<'a>>| {
        items.extend(value.map(|value| Item::List(vec![Item::text(name), value])));
    };
    said("color", color.map(|color| Item::Numbers(color.to_vec().into())));
    said("metallic", metallic.map(Item::Number));
    said("roughness", roughness.map(Item::Number));
    said("double sided", double_sided.map(u64::from).map(Item::Integer));
    said(
        "alpha",
        alpha.map(|alpha| {
            let cutoff = if let Alpha::Mask(cutoff) = alpha { Some(Item::Number(cutoff)) } else { None };
            Item::List([Item::text(alpha.name())].into_iter().chain(cutoff).collect())
        }),
    );
    said(
        "texture",
        texture.as_ref().map(|Texture { image, wrap, magnify, minify }| {
            let filter = |filter: &Option<Filter>| Item::text(filter.map_or("", Filter::name));
            let wrap = wrap.iter().map(|wrap| Item::text(wrap.name()));
            let bytes = Item::Bytes(image.bytes().into());
            Item::List([bytes, filter(magnify), filter(minify)].into_iter().chain(wrap).collect())
        }),
    );
    Item::List(items)
}

/// Returns the item of sharp edges or vertices, if there are any.
fn sharp(name: &str, sharp: &Sharp) -> Option<Item<'static>> {
    let (indices, values): (Vec<u32>, Vec<f64>) = sharp.iter().copied().unzip();
    let item = || Item::List(vec![Item::text(name), Item::Indices(indices.into()), Item::Numbers(values.into())]);
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
    given.map(|(name, array)| Item::List(vec![Item::text(name), Item::Numbers(array.into())])).collect()
}

fn faces(topology: &Topology) -> Item<'static> {
    let sizes: Vec<u32> = (0..topology.n_faces()).map(|f| index(topology.face(f).len())).collect();
    let vertices: Vec<u32> = (0..topology.n_faces()).flat_map(|f| topology.face(f)).copied().collect();
    Item::List(vec![Item::Indices(sizes.into()), Item::Indices(vertices.into())])
}

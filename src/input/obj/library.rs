//! Material libraries (MTL): colours, opacity, metalness, roughness, and a texture.
//!
//! Sources: Wavefront Technologies, Advanced Visualizer Manual (1995), chapter 5; for `Pm` and `Pr` the extension of
//! Exocortex Clara.io (2015).

use std::collections::BTreeMap;
use std::sync::Arc;

use crate::input::beside::Beside;
use crate::input::text::{MAX_NOTED_NAMES, first_names, number, numbers, quoted, text, without_comment};
use crate::shape::labels::FaceSet;
use crate::shape::looks::Look;
use crate::shape::textures::{Image, Texture, Wrap};

/// Maximum number of bytes of a library, and of a picture. Half of it would refuse pictures that cameras make; twice of
/// it adds nothing visible to a surface.
const MAX_LIBRARY_BYTES: u64 = 64 << 20;

/// Options of a picture statement, with the maximum number of arguments of each.
const PICTURE_OPTIONS: &[(&str, usize)] = &[
    ("-blendu", 1),
    ("-blendv", 1),
    ("-boost", 1),
    ("-bm", 1),
    ("-cc", 1),
    ("-clamp", 1),
    ("-colorspace", 1),
    ("-imfchan", 1),
    ("-mm", 2),
    ("-o", 3),
    ("-s", 3),
    ("-t", 3),
    ("-texres", 1),
    ("-type", 1),
];

/// The contents of the material libraries.
#[derive(Debug, Default)]
pub(super) struct MaterialLibrary {
    materials: BTreeMap<String, ObjMaterial>,
    /// The statements that are left out, with their number.
    left_out: BTreeMap<String, usize>,
    notes: Vec<String>,
    /// Whether the file names no library and none came with it.
    is_none: bool,
}

/// A material of a library.
#[derive(Debug, Default)]
struct ObjMaterial {
    color: Option<[f64; 3]>,
    /// The alpha of `d`, and of `Tr` as 1 minus its value; the first takes precedence.
    alpha: [Option<f64>; 2],
    metallic: Option<f64>,
    roughness: Option<f64>,
    /// The name of a picture, and its wrapping mode.
    picture: Option<(String, Wrap)>,
}

impl MaterialLibrary {
    /// Reads the libraries with these names beside the file, or the one that came with it.
    pub(super) fn beside(beside: &dyn Beside, names: &[String]) -> Self {
        let mut library = Self::default();
        if let Some(bytes) = beside.library() {
            library.add(bytes, "");
            return library;
        }
        library.is_none = names.is_empty();
        for name in names {
            let read = |name| beside.read(name, MAX_LIBRARY_BYTES).map(|bytes| (bytes, folder(name)));
            // a name may contain blanks, or be several names
            let several = || name.split(' ').map(read).collect::<Result<Vec<_>, _>>();
            match read(name).map(|one| vec![one]).or_else(|detail| several().map_err(|_| detail)) {
                Ok(found) => found.iter().for_each(|(bytes, folder)| library.add(bytes, folder)),
                Err(detail) => library.notes.push(format!("how materials look is left out: {detail}")),
            }
        }
        library
    }

    /// Adds the looks of these materials to the mesh, and notes what is left out.
    pub(super) fn looks(
        mut self,
        materials: &[FaceSet],
        has_uvs: bool,
        beside: &dyn Beside,
        notes: &mut Vec<String>,
    ) -> Vec<Look> {
        if materials.is_empty() {
            return Vec::new();
        }
        let mut images: BTreeMap<String, Option<Arc<Image>>> = BTreeMap::new();
        let mut looks = Vec::with_capacity(materials.len());
        let mut unknown = Vec::new();
        for material in materials {
            let entry = self.materials.remove(&material.name);
            if entry.is_none() {
                unknown.push(quoted(&material.name));
            }
            let entry = entry.unwrap_or_default();
            let mut look = entry.look();
            if let Some((name, wrap)) = entry.picture {
                let image = images.entry(name.clone()).or_insert_with(|| {
                    let image = beside.read(&name, MAX_LIBRARY_BYTES).and_then(Image::new);
                    let note = |detail| notes.push(format!("the texture {} is left out: {detail}", quoted(&name)));
                    image.map(Arc::new).map_err(note).ok()
                });
                if has_uvs {
                    look.texture = image.clone().map(|image| Texture { wrap: [wrap; 2], ..Texture::new(image) });
                } else {
                    self.leave_out("textures without texture coordinates".to_owned());
                }
            }
            looks.push(look);
        }
        if self.is_none {
            notes.push("how materials look is not told: the file names no library (mtllib), only materials".to_owned());
        } else if !unknown.is_empty() && self.notes.is_empty() {
            let (n, first) = (unknown.len(), first_names(unknown.into_iter()));
            notes.push(format!("how {n} materials look is not told, as no library has them: {first}"));
        }
        notes.append(&mut self.notes);
        if !self.left_out.is_empty() {
            let listed = self.left_out.iter().take(MAX_NOTED_NAMES).map(|(what, n)| format!("{what} ({n})"));
            let listed: Vec<String> = listed.collect();
            let more = if self.left_out.len() > MAX_NOTED_NAMES { ", and more" } else { "" };
            notes.push(format!("what libraries say of materials beyond this is left out: {}{more}", listed.join(", ")));
        }
        looks
    }

    fn leave_out(&mut self, what: String) {
        *self.left_out.entry(what).or_default() += 1;
    }

    /// Adds the materials of a library whose pictures are relative to `folder`. Existing materials keep their values.
    fn add(&mut self, bytes: &[u8], folder: &str) {
        let text = text(bytes);
        let mut current: Option<(String, ObjMaterial)> = None;
        for line in text.lines() {
            let line = without_comment(line).trim();
            let (keyword, rest) = line.split_once(char::is_whitespace).unwrap_or((line, ""));
            if keyword == "newmtl" {
                self.keep(current.replace((rest.trim().to_owned(), ObjMaterial::default())));
            } else if let Some((_, entry)) = &mut current
                && let Err(what) = entry.say(keyword, rest.trim(), folder)
            {
                self.leave_out(what);
            }
        }
        self.keep(current);
    }

    fn keep(&mut self, material: Option<(String, ObjMaterial)>) {
        if let Some((name, entry)) = material {
            self.materials.entry(name).or_insert(entry);
        }
    }
}

impl ObjMaterial {
    /// Reads a statement.
    ///
    /// # Errors
    /// The statement is left out; the error names it.
    fn say(&mut self, keyword: &str, rest: &str, folder: &str) -> Result<(), String> {
        let mut words = rest.split_ascii_whitespace();
        let within = |x: f64| x.clamp(0.0, 1.0);
        let one = || {
            let last = words.clone().last().and_then(|word| number(word).ok());
            last.map(within).ok_or_else(|| format!("{keyword} without a number"))
        };
        match keyword {
            "" => {}
            "Kd" => {
                let color = numbers::<3>(&mut words, "a colour").map_err(|_| "Kd without three numbers".to_owned())?;
                self.color = Some(color.map(within));
            }
            "d" => self.alpha[0] = Some(one()?),
            "Tr" => self.alpha[1] = Some(1.0 - one()?),
            "Pm" => self.metallic = Some(one()?),
            "Pr" => self.roughness = Some(one()?),
            "map_Kd" => return self.picture(rest, folder),
            _ if is_ignored(keyword, rest) => {}
            _ => return Err(quoted(keyword)),
        }
        Ok(())
    }

    /// Reads the options and the name of a picture.
    fn picture(&mut self, rest: &str, folder: &str) -> Result<(), String> {
        let (mut rest, mut wrap, mut moved) = (rest, Wrap::Repeat, Ok(()));
        while rest.starts_with('-') {
            let (option, after) = rest.split_once(char::is_whitespace).unwrap_or((rest, ""));
            let Some(&(_, most)) = PICTURE_OPTIONS.iter().find(|(name, _)| *name == option) else { break };
            rest = after.trim_start();
            for i in 0..most {
                let (word, after) = rest.split_once(char::is_whitespace).unwrap_or((rest, ""));
                // the second and third arguments of most options are optional
                if i > 0 && number(word).is_err() {
                    break;
                }
                if option == "-clamp" && word == "on" {
                    wrap = Wrap::ClampToEdge;
                }
                rest = after.trim_start();
            }
            if matches!(option, "-o" | "-s" | "-t") {
                moved = Err(format!("{} of map_Kd", quoted(option)));
            }
        }
        self.picture = (!rest.is_empty()).then(|| (format!("{folder}{rest}"), wrap));
        moved
    }

    fn look(&self) -> Look {
        let Self { color, alpha: [alpha, through], metallic, roughness, picture: _ } = self;
        let alpha = alpha.or(*through);
        let is_said = color.is_some() || alpha.is_some();
        let [red, green, blue] = color.unwrap_or([1.0; 3]);
        let color = is_said.then(|| [red, green, blue, alpha.unwrap_or(1.0)]);
        Look { color, metallic: *metallic, roughness: *roughness, ..Look::default() }
    }
}

/// Whether a statement has no visible effect: no emission and no highlight, all or none of the ambient light, no
/// refraction, and an illumination model without mirrors and glass.
fn is_ignored(keyword: &str, rest: &str) -> bool {
    let all =
        |values: &[f64]| rest.split_ascii_whitespace().all(|word| number(word).is_ok_and(|x| values.contains(&x)));
    match keyword {
        "Ke" | "Ks" => all(&[0.0]),
        "Ka" => all(&[0.0]) || all(&[1.0]),
        "Ni" => all(&[1.0]),
        "illum" => all(&[0.0, 1.0, 2.0]),
        _ => false,
    }
}

/// Returns the folder of a file with its trailing separator; empty for a file beside the main file.
fn folder(name: &str) -> &str {
    &name[..name.rfind(['/', '\\']).map_or(0, |at| at + 1)]
}

//! Accessors of glTF over buffer views, with every range checked against the bytes that exist.

use gltf::json::Index;
use gltf::json::accessor::{Accessor, ComponentType, Type};
use gltf::json::buffer::View;
use gltf::json::validation::Checked::Valid;

use super::buffers::GltfDocument;
use crate::input::collect::whole;
use crate::input::room::MemoryBudget;

/// Bytes of a number.
const ACCESSOR_NUMBER_BYTES: usize = size_of::<f64>();

/// Numbers in rows of `width`.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct AccessorRows {
    pub(super) width: usize,
    pub(super) values: Vec<f64>,
}

impl AccessorRows {
    /// Returns the bytes of the numbers, which the caller returns to the room after dropping them.
    pub(super) fn bytes(&self) -> usize {
        self.values.len() * ACCESSOR_NUMBER_BYTES
    }

    /// Returns the number of rows.
    pub(super) fn len(&self) -> usize {
        self.values.len() / self.width
    }

    /// Returns the rows if each has `N` numbers.
    pub(super) fn rows<const N: usize>(&self) -> Option<&[[f64; N]]> {
        (self.width == N).then(|| self.values.as_chunks::<N>().0)
    }
}

impl GltfDocument<'_> {
    /// Returns the accessor with this index.
    pub(super) fn accessor(&self, index: Index<Accessor>) -> Result<&Accessor, String> {
        let i = index.value();
        self.root
            .accessors
            .get(i)
            .ok_or_else(|| format!("there is no accessor {i}; the file has {}", self.root.accessors.len()))
    }

    /// Reads the scalars or vectors of an accessor. Normalized integers are mapped to -1..1 or 0..1.
    pub(super) fn rows(&self, index: Index<Accessor>, room: &mut MemoryBudget) -> Result<AccessorRows, String> {
        let accessor = self.accessor(index)?;
        let place = |detail: String| format!("accessor {}: {detail}", index.value());
        let (component, width) = kind(accessor).map_err(place)?;
        let n = usize::try_from(accessor.count.0).unwrap_or(usize::MAX);
        let mut values = match accessor.buffer_view {
            None => {
                let zeros = n.saturating_mul(width * ACCESSOR_NUMBER_BYTES);
                let without = |detail| place(format!("it has {n} elements and no bufferView: {detail}"));
                room.take(zeros).map_err(without)?;
                vec![0.0; n * width]
            }
            Some(view) => {
                let offset = accessor.byte_offset.map_or(0, |offset| offset.0);
                self.numbers(view, [offset, n as u64], component, width, accessor.normalized, room).map_err(place)?
            }
        };
        if let Some(sparse) = &accessor.sparse {
            let Valid(kind) = sparse.indices.component_type else {
                return Err(place("the indices of its sparse rows are of no known type".to_owned()));
            };
            let count = usize::try_from(sparse.count.0).unwrap_or(usize::MAX).min(n.saturating_add(1));
            if count > n {
                return Err(place(format!("more sparse rows than its {n} rows")));
            }
            let offset = sparse.indices.byte_offset.0;
            let at = self.numbers(sparse.indices.buffer_view, [offset, count as u64], kind.0, 1, false, room);
            let at = at.map_err(place)?;
            let range = [sparse.values.byte_offset.0, count as u64];
            let new = self.numbers(sparse.values.buffer_view, range, component, width, accessor.normalized, room);
            if let Some(&[before, after, ..]) = at.windows(2).find(|pair| pair[1] <= pair[0]) {
                return Err(place(format!("sparse row {after} after {before}; they have to increase")));
            }
            for (row, new) in at.into_iter().zip(new.map_err(place)?.chunks_exact(width)) {
                let row = whole(row).map(|row| row as usize).filter(|&row| row < n);
                let row = row.ok_or_else(|| place(format!("a sparse row beyond its {n} rows")))?;
                values[row * width..(row + 1) * width].copy_from_slice(new);
            }
            room.give(count * (1 + width) * ACCESSOR_NUMBER_BYTES);
        }
        Ok(AccessorRows { width, values })
    }

    /// Reads the whole numbers of an accessor of indices, and takes their memory from the room.
    pub(super) fn indices(&self, index: Index<Accessor>, room: &mut MemoryBudget) -> Result<Vec<u32>, String> {
        let (component, width) = kind(self.accessor(index)?)?;
        if width != 1 || matches!(component, ComponentType::F32 | ComponentType::I8 | ComponentType::I16) {
            return Err(format!("accessor {}: indices are unsigned scalars", index.value()));
        }
        let rows = self.rows(index, room)?;
        room.take(rows.len() * size_of::<u32>())?;
        let mut found = Vec::with_capacity(rows.len());
        found.extend(rows.values.iter().filter_map(|&x| whole(x)));
        room.give(rows.bytes());
        Ok(found)
    }

    fn numbers(
        &self,
        view: Index<View>,
        [offset, n]: [u64; 2],
        component: ComponentType,
        width: usize,
        normalized: bool,
        room: &mut MemoryBudget,
    ) -> Result<Vec<f64>, String> {
        let n = usize::try_from(n).unwrap_or(usize::MAX);
        let (bytes, stride) = self.view(view)?;
        let row = size(component) * width;
        let stride = stride.unwrap_or(row);
        if stride < row {
            return Err(format!("its rows of {row} bytes lie {stride} bytes apart"));
        }
        let offset = usize::try_from(offset).unwrap_or(usize::MAX);
        let end = n.checked_sub(1).map_or(Some(0), |n| n.checked_mul(stride)?.checked_add(row));
        let needed = end.and_then(|end| end.checked_add(offset));
        if needed.is_none_or(|needed| needed > bytes.len()) {
            let n_bytes = bytes.len();
            return Err(format!(
                "{n} rows, {stride} bytes apart, from byte {offset} of a view of {n_bytes} bytes; too many"
            ));
        }
        room.take(n * width * ACCESSOR_NUMBER_BYTES)?;
        let mut values = Vec::with_capacity(n * width);
        for i in 0..n {
            let start = offset + i * stride;
            let numbers = bytes[start..start + row].chunks_exact(size(component));
            values.extend(numbers.map(|number| value(number, component, normalized)));
        }
        Ok(values)
    }

    /// Returns the bytes of a view and the stride of its rows.
    pub(super) fn view(&self, index: Index<View>) -> Result<(&[u8], Option<usize>), String> {
        let i = index.value();
        let view = self.root.buffer_views.get(i).ok_or_else(|| format!("there is no bufferView {i}"))?;
        let stride = view.byte_stride.map(|stride| stride.0).filter(|&stride| stride > 0);
        if let Some(bytes) = self.unpacked.get(&i) {
            return Ok((bytes, stride));
        }
        let b = view.buffer.value();
        let buffer = self.buffers.get(b).ok_or_else(|| format!("bufferView {i}: there is no buffer {b}"))?;
        let start = view.byte_offset.map_or(0, |offset| offset.0);
        let end = start.checked_add(view.byte_length.0);
        let range = usize::try_from(start).ok().zip(end.and_then(|end| usize::try_from(end).ok()));
        let bytes = range.and_then(|(start, end)| buffer.get(start..end)).ok_or_else(|| {
            let length = view.byte_length.0;
            format!("bufferView {i}: {length} bytes from byte {start}; buffer {b} has {}", buffer.len())
        })?;
        Ok((bytes, stride))
    }
}

/// Returns the type and the number of components of an accessor.
fn kind(accessor: &Accessor) -> Result<(ComponentType, usize), String> {
    let Valid(component) = accessor.component_type else { return Err("its componentType is not known".to_owned()) };
    let width = match accessor.type_ {
        Valid(Type::Scalar) => 1,
        Valid(Type::Vec2) => 2,
        Valid(Type::Vec3) => 3,
        Valid(Type::Vec4) => 4,
        _ => return Err("its type is not SCALAR, VEC2, VEC3 or VEC4".to_owned()),
    };
    Ok((component.0, width))
}

fn size(component: ComponentType) -> usize {
    match component {
        ComponentType::I8 | ComponentType::U8 => 1,
        ComponentType::I16 | ComponentType::U16 => 2,
        ComponentType::U32 | ComponentType::F32 => 4,
    }
}

/// Decodes a number from the bytes of its type. Source: glTF 2.0, section 3.11 (normalized numbers).
fn value(bytes: &[u8], component: ComponentType, normalized: bool) -> f64 {
    let two = || [bytes[0], bytes[1]];
    let four = || [bytes[0], bytes[1], bytes[2], bytes[3]];
    let (x, full): (f64, f64) = match component {
        ComponentType::I8 => (i8::from_le_bytes([bytes[0]]).into(), 127.0),
        ComponentType::U8 => (bytes[0].into(), 255.0),
        ComponentType::I16 => (i16::from_le_bytes(two()).into(), 32_767.0),
        ComponentType::U16 => (u16::from_le_bytes(two()).into(), 65_535.0),
        ComponentType::U32 => (u32::from_le_bytes(four()).into(), 4_294_967_295.0),
        ComponentType::F32 => return f32::from_le_bytes(four()).into(),
    };
    if normalized { (x / full).max(-1.0) } else { x }
}

//! The layout of a glTF buffer: views one after another, and accessors into them.

use gltf::json::accessor::{ComponentType, GenericComponentType, Type};
use gltf::json::buffer::{Stride, Target, View};
use gltf::json::validation::Checked::Valid;
use gltf::json::{Accessor, Extras, Index, Root};

/// Bytes of one number of a channel.
pub(super) const CHANNEL_NUMBER_BYTES: u128 = 4;

/// The views of a document, each starting at the first multiple of 4 after the end of the one before.
pub(super) struct Views<'a>(&'a mut Root);

impl<'a> Views<'a> {
    /// Takes the buffer views of a document.
    pub(super) fn of(root: &'a mut Root) -> Self {
        Self(root)
    }

    /// Adds a view with `stride` bytes for each of `n` vertices; returns its number.
    pub(super) fn vertices(self, n: u128, stride: u128) -> u32 {
        let stride_of = usize::try_from(stride).expect("a vertex has few numbers");
        self.add(n * stride, Some(Stride(stride_of)), Some(Target::ArrayBuffer))
    }

    /// Adds a view for indices; returns its number.
    pub(super) fn indices(self, bytes: u128) -> u32 {
        self.add(bytes, None, Some(Target::ElementArrayBuffer))
    }

    /// Adds a view for numbers that are not drawn; returns its number.
    pub(super) fn loose(self, bytes: u128) -> u32 {
        self.add(bytes, None, None)
    }

    fn add(self, bytes: u128, byte_stride: Option<Stride>, target: Option<Target>) -> u32 {
        let views = &mut self.0.buffer_views;
        let end = |last: &View| last.byte_offset.map_or(0, |start| start.0) + last.byte_length.0;
        let start = views.last().map_or(0, end).next_multiple_of(4);
        views.push(View {
            buffer: Index::new(0),
            byte_length: length(bytes).into(),
            byte_offset: (start > 0).then(|| start.into()),
            byte_stride,
            name: None,
            target: target.map(Valid),
            extensions: None,
            extras: Extras::default(),
        });
        u32::try_from(views.len() - 1).expect("there are few views")
    }
}

/// Returns an accessor to `count` items in a view, from its byte `start` on.
pub(super) fn accessor(view: u32, start: u128, count: u128, component: ComponentType, kind: Type) -> Accessor {
    Accessor {
        buffer_view: Some(Index::new(view)),
        byte_offset: (start > 0).then(|| length(start).into()),
        count: length(count).into(),
        component_type: Valid(GenericComponentType(component)),
        extensions: None,
        extras: Extras::default(),
        type_: Valid(kind),
        min: None,
        max: None,
        name: None,
        normalized: false,
        sparse: None,
    }
}

/// Converts a length that is known to be the length of something in memory or behind 32-bit indices.
pub(super) fn length(n: u128) -> u64 {
    u64::try_from(n).expect("numbers of rows are below 2^40")
}

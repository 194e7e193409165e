//! What a pair keeps from step to step, in parry's workspace.

use crate::parry::query::details::VoxelsShapeContactManifoldsWorkspace;
use crate::parry::query::{ContactManifoldsWorkspace, TypedWorkspaceData, WorkspaceData};
use bevy_faceoff::queries::PairMemory;

/// The only workspace of parry that other crates can make.
type SavedAs = VoxelsShapeContactManifoldsWorkspace<2>;

/// The memory of a pair of exact meshes. It saves work and changes no result.
struct Memory {
    pair: PairMemory,
    /// The memory is saved as this workspace of parry, always empty: parry loads no workspace of another crate.
    saved_as: SavedAs,
}

/// The memory in a pair's workspace. What it holds of another pair of shapes is replaced.
pub fn of(workspace: &mut Option<ContactManifoldsWorkspace>) -> &mut PairMemory {
    let is_ours = workspace
        .as_ref()
        .is_some_and(|w| w.0.downcast_ref::<Memory>().is_some());
    if !is_ours {
        *workspace = None;
    }
    let workspace = workspace.get_or_insert_with(|| ContactManifoldsWorkspace(Box::new(Memory::new())));
    let memory = workspace.0.downcast_mut::<Memory>().expect("any other was replaced");
    &mut memory.pair
}

impl Memory {
    fn new() -> Self {
        Self {
            pair: PairMemory::default(),
            saved_as: SavedAs::new(),
        }
    }
}

impl WorkspaceData for Memory {
    fn as_typed_workspace_data(&self) -> TypedWorkspaceData<'_> {
        TypedWorkspaceData::VoxelsShapeContactManifoldsWorkspace(&self.saved_as)
    }

    /// A copy of a world is to be small, so it begins without memory.
    fn clone_dyn(&self) -> Box<dyn WorkspaceData> {
        Box::new(Self::new())
    }
}

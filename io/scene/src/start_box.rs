//! Box of the start file, for scenes without a box.

use crate::StartSource;
use crate::document::{Node, Value};
use crate::key_error::KeyError;
use std::path::Path;

/// Edges of the box in a start file; `None` if the file has no box. The error says why the file cannot be read.
pub type EdgesOfStartFile = fn(&StartSource) -> Result<Option<[f64; 3]>, String>;

/// Setting of `box.edges` from the file that a suspension starts from, if the scene has no edges and the file has
/// some. The strain of the box is taken when the scene is run.
pub(super) fn missing_edges(
    document: &Node,
    folder: &Path,
    edges_of: EdgesOfStartFile,
) -> Result<Option<String>, KeyError> {
    let text_at =
        |section: &str, key: &str| document.get(section).and_then(|section| section.get(key)).and_then(Node::text);
    let has_box = document.get("box").is_some_and(|cell| cell.get("edges").is_some());
    let is_suspension = document.get("kind").is_none_or(|kind| kind.text() == Some("suspension"));
    let is_stretched = text_at("flow", "kind").is_some_and(|kind| kind.ends_with("extension"));
    if has_box || !is_suspension || is_stretched || is_open(document) || text_at("particles", "initial") != Some("file")
    {
        return Ok(None);
    }
    let Some(path) = text_at("particles", "path") else { return Ok(None) };
    let group = text_at("particles", "group").map(str::to_owned);
    let source = StartSource { path: folder.join(path), frame: frame(document), group };
    let edges = edges_of(&source).map_err(|error| KeyError::new("box.edges", format!("are missing, and {error}")))?;
    Ok(edges.map(|[x, y, z]| format!("box.edges=[{x:?}, {y:?}, {z:?}]")))
}

/// Whether the fluid is open along all axes, in which case there is no box.
fn is_open(document: &Node) -> bool {
    let boundaries = document.get("box").and_then(|cell| cell.get("boundaries"));
    let Some(Value::List(axes)) = boundaries.map(|list| &list.value) else { return false };
    axes.iter().all(|axis| axis.text() == Some("open"))
}

/// The frame, if it is a number; other values are refused when all keys are read.
fn frame(document: &Node) -> Option<i64> {
    let Value::Whole(number) = document.get("particles")?.get("frame")?.value else { return None };
    let size = i64::try_from(number.size).ok()?;
    Some(if number.is_negative { -size } else { size })
}

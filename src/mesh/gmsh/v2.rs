//! Version 2.2: every node and element on its own line; an element carries the number of its physical group.

use std::collections::HashMap;

use super::text::Words;
use super::{Contents, Node, read};

/// `number x y z` for each.
pub(super) fn nodes(words: &mut Words, contents: &mut Contents) -> Result<(), String> {
    let count: usize = words.number("the number of nodes")?;
    for _ in 0..count {
        let tag = words.number("the number of a node")?;
        contents.nodes.push(Node { tag, place: read::place(words)? });
    }
    Ok(())
}

/// `number type tags... nodes...` for each, the first tag being the physical group (0 = none).
pub(super) fn elements(words: &mut Words, contents: &mut Contents) -> Result<(), String> {
    let count: usize = words.number("the number of elements")?;
    let mut known: HashMap<i64, usize> = HashMap::new();
    for _ in 0..count {
        let tag = words.number("the number of an element")?;
        let kind = words.number("the type of an element")?;
        let tags: usize = words.number("the number of tags")?;
        let physical: i64 = if tags > 0 { words.number("the number of a physical group")? } else { 0 };
        words.skip(tags.saturating_sub(1))?;
        let group = *known.entry(physical).or_insert_with(|| {
            contents.groups.push(if physical == 0 { Vec::new() } else { vec![physical.abs()] });
            contents.groups.len() - 1
        });
        read::element(words, contents, kind, (tag, group))?;
    }
    Ok(())
}

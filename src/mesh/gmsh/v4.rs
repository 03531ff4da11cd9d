//! Version 4.1: nodes and elements in blocks, each of one entity of the geometry; physical groups belong to entities.

use std::collections::HashMap;

use super::text::Words;
use super::{Contents, Node, read};

/// The physical groups of the entities: (dimension, number) to the index of a list of groups.
#[derive(Default)]
pub(super) struct Entities(HashMap<(usize, i64), usize>);

impl Entities {
    /// Four counts, then for each entity its number, its box (a point: its place), its groups and its boundary.
    pub fn read(words: &mut Words, contents: &mut Contents) -> Result<Self, String> {
        let mut counts = [0_usize; 4];
        for count in &mut counts {
            *count = words.number("a number of entities")?;
        }
        let mut entities = HashMap::new();
        for (dimension, count) in counts.into_iter().enumerate() {
            for _ in 0..count {
                let tag: i64 = words.number("the number of an entity")?;
                words.skip(if dimension == 0 { 3 } else { 6 })?;
                let groups: usize = words.number("the number of physical groups")?;
                let group = |_| words.number::<i64>("the number of a physical group").map(i64::abs);
                contents.groups.push((0..groups).map(group).collect::<Result<_, _>>()?);
                entities.insert((dimension, tag), contents.groups.len() - 1);
                if dimension > 0 {
                    let bounds = words.number("the number of bounding entities")?;
                    words.skip(bounds)?;
                }
            }
        }
        Ok(Self(entities))
    }
}

/// Blocks `dimension entity parametric count`, the numbers of the nodes, then their coordinates.
pub(super) fn nodes(words: &mut Words, contents: &mut Contents) -> Result<(), String> {
    let blocks: usize = words.number("the number of blocks")?;
    words.skip(3)?;
    for _ in 0..blocks {
        let dimension: usize = words.number("the dimension of an entity")?;
        words.skip(1)?;
        let parametric: usize = words.number("0 or 1, whether parametric")?;
        let count: usize = words.number("the number of nodes")?;
        let first = contents.nodes.len();
        for _ in 0..count {
            contents.nodes.push(Node { tag: words.number("the number of a node")?, place: [0.0; 3] });
        }
        for node in first..first + count {
            contents.nodes[node].place = read::place(words)?;
            words.skip(if parametric == 1 { dimension } else { 0 })?;
        }
    }
    Ok(())
}

/// Blocks `dimension entity type count`, then `number nodes...` for each element.
pub(super) fn elements(words: &mut Words, contents: &mut Contents, entities: &Entities) -> Result<(), String> {
    let blocks: usize = words.number("the number of blocks")?;
    words.skip(3)?;
    contents.groups.push(Vec::new());
    let none = contents.groups.len() - 1;
    for _ in 0..blocks {
        let dimension: usize = words.number("the dimension of an entity")?;
        let entity: i64 = words.number("the number of an entity")?;
        let kind = words.number("the type of the elements")?;
        let count: usize = words.number("the number of elements")?;
        let group = entities.0.get(&(dimension, entity)).copied().unwrap_or(none);
        for _ in 0..count {
            let tag = words.number("the number of an element")?;
            read::element(words, contents, kind, (tag, group))?;
        }
    }
    Ok(())
}

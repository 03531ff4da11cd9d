//! Version 4.1: nodes and elements in blocks, each of one entity of the geometry; physical groups belong to entities.

use std::collections::HashMap;

use super::input::Input;
use super::{Contents, Node, read};

/// The physical groups of the entities: (dimension, number) to the index of a list of groups.
#[derive(Default)]
pub(super) struct Entities(HashMap<(i64, i64), usize>);

impl Entities {
    /// Four counts, then for each entity its number, its box (a point: its place), its groups and its boundary.
    pub fn read(input: &mut Input, contents: &mut Contents) -> Result<Self, String> {
        begin(input);
        let mut counts = [0; 4];
        for count in &mut counts {
            *count = input.size("a number of entities")?;
        }
        let mut entities = HashMap::new();
        for (dimension, count) in (0..).zip(counts) {
            for _ in 0..count {
                let tag = input.int("the number of an entity")?;
                input.skip_reals(if dimension == 0 { 3 } else { 6 })?;
                let groups = input.size("the number of physical groups")?;
                let group = |_| input.int("the number of a physical group").map(i64::abs);
                contents.groups.push((0..groups).map(group).collect::<Result<_, _>>()?);
                entities.insert((dimension, tag), contents.groups.len() - 1);
                if dimension > 0 {
                    let bounds = input.size("the number of bounding entities")?;
                    input.skip_ints(bounds)?;
                }
            }
        }
        Ok(Self(entities))
    }
}

/// Blocks `dimension entity parametric count`, the numbers of the nodes, then their coordinates.
pub(super) fn nodes(input: &mut Input, contents: &mut Contents) -> Result<(), String> {
    begin(input);
    let blocks = input.size("the number of blocks")?;
    input.skip_sizes(3)?;
    for _ in 0..blocks {
        let dimension = input.int("the dimension of an entity")?;
        input.skip_ints(1)?;
        let parametric = input.int("0 or 1, whether parametric")?;
        let count = input.size("the number of nodes")?;
        let first = contents.nodes.len();
        for _ in 0..count {
            contents.nodes.push(Node { tag: input.size("the number of a node")?, place: [0.0; 3] });
        }
        for node in &mut contents.nodes[first..] {
            node.place = input.place()?;
            input.skip_reals(if parametric == 1 { dimension.clamp(0, 3) as u64 } else { 0 })?;
        }
    }
    Ok(())
}

/// Blocks `dimension entity type count`, then `number nodes...` for each element.
pub(super) fn elements(input: &mut Input, contents: &mut Contents, entities: &Entities) -> Result<(), String> {
    begin(input);
    let blocks = input.size("the number of blocks")?;
    input.skip_sizes(3)?;
    contents.groups.push(Vec::new());
    let none = contents.groups.len() - 1;
    for _ in 0..blocks {
        let dimension = input.int("the dimension of an entity")?;
        let entity = input.int("the number of an entity")?;
        let kind = input.int("the type of the elements")?;
        let count = input.size("the number of elements")?;
        let group = entities.0.get(&(dimension, entity)).copied().unwrap_or(none);
        for _ in 0..count {
            let tag = input.size("the number of an element")?;
            let kind = read::kind(input, kind, tag)?;
            read::element(contents, (kind, tag, group), || input.size("the number of a node"))?;
        }
    }
    Ok(())
}

/// Bytes begin on the line after the name of the section.
fn begin(input: &mut Input) {
    if !input.is_text() {
        input.next_line();
    }
}

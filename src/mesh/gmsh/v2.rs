//! Versions 2.0 to 2.2: every node and element on its own; an element carries the number of its physical group.

use std::collections::HashMap;

use super::input::Input;
use super::{Contents, Node, read};

/// `number x y z` for each.
pub(super) fn nodes(input: &mut Input, contents: &mut Contents) -> Result<(), String> {
    let count: u64 = counted(input, "the number of nodes")?;
    for _ in 0..count {
        let tag = tag(input, "the number of a node")?;
        contents.nodes.push(Node { tag, place: input.place()? });
    }
    Ok(())
}

/// `number type tags... nodes...` for each, the first tag being the physical group (0 = none). In binary files, runs of
/// elements of one kind: `type count tags`, then `number tags... nodes...` for each.
pub(super) fn elements(input: &mut Input, contents: &mut Contents) -> Result<(), String> {
    let count: u64 = counted(input, "the number of elements")?;
    let mut groups = Groups::default();
    let mut done = 0;
    while done < count {
        let (mut number, mut kind) = (0, 0);
        if input.is_text() {
            number = tag(input, "the number of an element")?;
            kind = input.int("the type of an element")?;
        }
        let (kind, run) = match input.is_text() {
            true => (kind, 1),
            false => (input.int("the type of elements")?, tag(input, "the number of elements of a type")?),
        };
        let tags = tag(input, "the number of tags")?;
        for _ in 0..run {
            if !input.is_text() {
                number = tag(input, "the number of an element")?;
            }
            let kind = read::kind(input, kind, number)?;
            let physical = if tags > 0 { input.int("the number of a physical group")? } else { 0 };
            input.skip_ints(tags.saturating_sub(1))?;
            let group = groups.of(physical, contents);
            read::element(contents, (kind, number, group), || tag(input, "the number of a node"))?;
        }
        done += run.max(1);
    }
    Ok(())
}

/// Where the list of each physical group is among those of the contents.
#[derive(Default)]
struct Groups(HashMap<i64, usize>);

impl Groups {
    fn of(&mut self, physical: i64, contents: &mut Contents) -> usize {
        *self.0.entry(physical).or_insert_with(|| {
            contents.groups.push(if physical == 0 { Vec::new() } else { vec![physical.abs()] });
            contents.groups.len() - 1
        })
    }
}

/// A count, which is text in every file; bytes begin on the line after it.
fn counted(input: &mut Input, what: &str) -> Result<u64, String> {
    let count = input.written(what)?;
    if !input.is_text() {
        input.next_line();
    }
    Ok(count)
}

/// An integer that cannot be negative.
fn tag(input: &mut Input, what: &str) -> Result<u64, String> {
    let number = input.int(what)?;
    u64::try_from(number).map_err(|_| input.error(format!("must be {what}, got {number}")))
}

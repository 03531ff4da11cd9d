//! README.md, docs/ and CHANGELOG.md: their links lead somewhere, the files and names that they speak of exist, and every block of
//! TOML, shell and Python does what a comment above it says (docs/CONTRIBUTING.md, "These pages").
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod common;

use std::collections::HashSet;
use std::path::{Path, PathBuf};
use std::process::Command;

use common::program::{MPJR, output_of};
use common::{directory, mpi};

/// Every page, by its path in the repository.
fn pages() -> Vec<PathBuf> {
    let entries = std::fs::read_dir(directory("docs")).unwrap().map(|entry| entry.unwrap().path());
    let mut pages: Vec<PathBuf> = entries.filter(|path| path.extension().is_some_and(|end| end == "md")).collect();
    pages.extend(["README.md", "CHANGELOG.md"].map(directory));
    pages.sort();
    pages
}

fn text(page: &Path) -> String {
    std::fs::read_to_string(page).unwrap()
}

/// The lines of a page that are no code.
fn prose(text: &str) -> impl Iterator<Item = &str> {
    let mut code = false;
    text.lines().filter(move |line| {
        let fence = line.starts_with("```");
        code ^= fence;
        !code && !fence
    })
}

/// The anchors of a page's headings, as GitHub and mdBook make them.
fn anchors(text: &str) -> HashSet<String> {
    let anchor = |heading: &str| -> String {
        let letters = heading.trim_start_matches('#').trim().to_lowercase();
        let kept = letters.chars().filter(|c| c.is_alphanumeric() || " -_".contains(*c));
        kept.map(|c| if c == ' ' { '-' } else { c }).collect()
    };
    prose(text).filter(|line| line.starts_with('#')).map(anchor).collect()
}

/// Links to other pages, to headings and to pictures.
#[test]
fn links_lead_somewhere() {
    let mut dead = Vec::new();
    let mut count = 0;
    for page in pages() {
        let text = text(&page);
        for line in prose(&text) {
            let targets = line.split("](").skip(1).filter_map(|rest| rest.split(')').next());
            for target in targets.filter(|target| !target.contains("://")) {
                count += 1;
                let (file, anchor) = target.split_once('#').unwrap_or((target, ""));
                let other = if file.is_empty() { page.clone() } else { page.parent().unwrap().join(file) };
                let found = other.exists() && (anchor.is_empty() || anchors(&self::text(&other)).contains(anchor));
                if !found {
                    dead.push(format!("{}: {target}", page.display()));
                }
            }
        }
    }
    assert!(count > 30 && dead.is_empty(), "{count} links; dead: {dead:#?}");
}

/// All pages of docs/ are chapters of the book.
#[test]
fn the_book_has_every_page() {
    let summary = text(&directory("docs/SUMMARY.md"));
    for page in pages().iter().filter(|page| page.parent() == Some(&directory("docs"))) {
        let name = page.file_name().unwrap().to_str().unwrap();
        assert!(name == "SUMMARY.md" || summary.contains(&format!("({name})")), "{name} is not in docs/SUMMARY.md");
    }
}

/// Paths of the repository in code marks exist; names after the path of a source file, in a table, are defined there.
#[test]
fn files_and_names_exist() {
    let mut missing = Vec::new();
    let mut count = 0;
    for page in pages() {
        for line in prose(&text(&page)) {
            let mut source: Option<String> = None;
            for marked in line.split('`').skip(1).step_by(2) {
                let ours = ["src/", "tests/", "ci/", "runs/", "meshes/", "benches/"];
                if ours.iter().any(|start| marked.starts_with(start)) && !marked.contains(['*', ' ', '<', '{']) {
                    count += 1;
                    let path = directory(marked);
                    if !path.exists() {
                        missing.push(format!("{}: {marked}", page.display()));
                    }
                    source = marked.ends_with(".rs").then(|| std::fs::read_to_string(path).unwrap_or_default());
                } else if let Some(source) = source.as_ref().filter(|_| line.starts_with('|')) {
                    let mut names = marked.split("::");
                    if names.any(|name| !defines(source, name)) {
                        missing.push(format!("{}: {marked}", page.display()));
                    }
                }
            }
        }
    }
    assert!(count > 100 && missing.is_empty(), "{count} paths; missing: {missing:#?}");
}

/// Whether a source file defines a function or a type, or implements one.
fn defines(source: &str, name: &str) -> bool {
    source.lines().any(|line| {
        let words: Vec<&str> = line.split(|c: char| !c.is_alphanumeric() && c != '_').collect();
        let defining = ["fn", "struct", "enum", "trait", "impl", "for", "type", "const"];
        words.iter().position(|word| defining.contains(word)).is_some_and(|at| words[at..].contains(&name))
    })
}

/// The table at the head of src/lib.rs has every module, and each uses none of a row above its own.
#[test]
fn layers_use_those_below() {
    let map = text(&directory("src/lib.rs"));
    let rows = map.lines().filter(|line| line.starts_with("//! | ["));
    let first = |row: &str| row.split('|').nth(1).unwrap().split('`').skip(1).step_by(2).map(str::to_owned).collect();
    let layers: Vec<Vec<String>> = rows.map(first).collect();
    let layer = |module: &str| layers.iter().position(|row| row.iter().any(|other| other == module));
    let mut upward = Vec::new();
    for module in map.lines().filter_map(|line| line.strip_prefix("pub mod ")?.strip_suffix(';')) {
        let mine = layer(module).unwrap_or_else(|| panic!("{module} is not in the table of src/lib.rs"));
        for file in sources(&directory("src"), module) {
            let source = text(&file);
            let code = source.split("#[cfg(test)]").next().unwrap();
            for used in code
                .lines()
                .filter(|line| !line.trim().starts_with("//"))
                .flat_map(|line| line.split("crate::").skip(1))
            {
                let used = used.split(|c: char| !c.is_alphanumeric() && c != '_').next().unwrap();
                if layer(used).is_some_and(|other| other < mine) {
                    upward.push(format!("{}: {used}", file.display()));
                }
            }
        }
    }
    assert!(layers.len() > 8 && upward.is_empty(), "{upward:#?}");
}

/// The source files of a module, but for those of tests.
fn sources(folder: &Path, module: &str) -> Vec<PathBuf> {
    let mut found: Vec<PathBuf> =
        [folder.join(format!("{module}.rs"))].into_iter().filter(|file| file.exists()).collect();
    let mut folders = vec![folder.join(module)];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).into_iter().flatten() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else if !path.file_stem().unwrap().to_str().unwrap().ends_with("tests") {
                found.push(path);
            }
        }
    }
    found
}

/// A block of code, and what the comment above it says.
struct Block {
    language: String,
    mark: Option<String>,
    code: String,
}

fn blocks(text: &str) -> Vec<Block> {
    let mut found = Vec::new();
    let mut lines = text.lines().peekable();
    let mut before = "";
    while let Some(line) = lines.next() {
        if let Some(language) = line.strip_prefix("```") {
            let code: Vec<&str> = lines.by_ref().take_while(|line| !line.starts_with("```")).collect();
            let mark = before.strip_prefix("<!-- ").and_then(|mark| mark.strip_suffix(" -->")).map(str::to_owned);
            found.push(Block { language: language.to_owned(), mark, code: code.join("\n") + "\n" });
        }
        before = line;
    }
    found
}

/// Does what is said of the blocks of a page, in a directory of its own.
fn carry_out(page: &Path) -> usize {
    let work = tempfile::tempdir().unwrap();
    for shared in ["runs", "meshes"] {
        std::os::unix::fs::symlink(directory(shared), work.path().join(shared)).unwrap();
    }
    let mut done = 0;
    for Block { language, mark, code } in blocks(&text(page)) {
        let needed = ["toml", "sh", "python", "csv"].contains(&language.as_str());
        let Some(mark) = mark else {
            assert!(!needed, "{}: nothing is said of this {language}:\n{code}", page.display());
            continue;
        };
        if let Some(file) = mark.strip_prefix("file: ") {
            let (name, before) = match file.split_once(" after ") {
                Some((name, other)) => (name, std::fs::read_to_string(work.path().join(other)).unwrap() + "\n"),
                None => (file, String::new()),
            };
            std::fs::write(work.path().join(name), before + &code).unwrap();
            continue;
        }
        if mark.starts_with("not run: ") {
            continue;
        }
        assert_eq!(mark, "run", "{}: what is that?", page.display());
        let mut command = match language.as_str() {
            "sh" => Command::new("sh"),
            // Debian's own, which has h5py.
            "python" => Command::new("/usr/bin/python3"),
            other => panic!("{}: {other} is not run", page.display()),
        };
        if language == "sh" {
            command.arg("-e");
        }
        let here = Path::new(MPJR).parent().unwrap();
        let path = format!("{}:{}", here.display(), std::env::var("PATH").unwrap());
        command.arg("-c").arg(&code).current_dir(&work).env("PATH", path).env("OMP_NUM_THREADS", "1");
        command.envs(mpi::mpirun(1).get_envs().filter_map(|(key, value)| Some((key, value?))));
        println!("{}:\n{code}{}", page.display(), output_of(&mut command));
        done += 1;
    }
    done
}

/// Every block of TOML, shell and Python, page by page.
#[test]
fn blocks_do_what_they_say() {
    let done: usize = pages().iter().map(|page| carry_out(page)).sum();
    assert!(done >= 11, "only {done} blocks are run");
}

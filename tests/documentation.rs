//! Documentation that rots is worse than none: links point somewhere, and every command is mentioned.

use crate::sandbox::repository;
use reenact::document::Source;
use reenact::{cli, world};
use std::path::{Path, PathBuf};

/// Returns the Markdown files of `folder` and below.
fn markdown_in(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            found.extend(markdown_in(&path));
        } else if path.extension().is_some_and(|e| e == "md") {
            found.push(path);
        }
    }
    found.sort();
    found
}

/// Returns the targets of the inline links `[text](target)` of a Markdown text, outside of fenced code.
fn links(text: &str) -> Vec<String> {
    let mut fenced = false;
    let prose: Vec<&str> = text
        .lines()
        .filter(|line| {
            let is_fence = line.trim_start().starts_with("```");
            fenced ^= is_fence;
            !fenced && !is_fence
        })
        .collect();
    let prose = prose.join("\n");
    let ends = prose.split("](").skip(1).filter_map(|rest| rest.split_once(')'));
    ends.map(|(target, _)| target.to_owned()).collect()
}

#[test]
fn links_are_found_outside_of_code() {
    let text = "a [b](c.md), [d](https://e)\n```\n[f](g.md)\n```\n[h](i.md#j)";
    assert_eq!(links(text), ["c.md", "https://e", "i.md#j"]);
}

#[test]
fn every_relative_link_points_to_a_file() {
    let mut pages: Vec<PathBuf> =
        ["README.md", "CHANGELOG.md", "CONTRIBUTING.md"].map(|name| repository().join(name)).into();
    pages.extend(markdown_in(&repository().join("docs")));
    let mut dead = Vec::new();
    let mut followed = 0;
    for page in &pages {
        let text = std::fs::read_to_string(page).unwrap();
        for link in links(&text) {
            let target = link.split('#').next().unwrap_or_default();
            // What a forge shows beside the code has no file: its releases.
            let is_elsewhere = target.contains("://") || target.starts_with("../../releases");
            if target.is_empty() || is_elsewhere {
                continue;
            }
            followed += 1;
            if !page.parent().unwrap().join(target).exists() {
                dead.push(format!(
                    "{}: {link}",
                    page.strip_prefix(repository()).unwrap().display()
                ));
            }
        }
    }
    assert_eq!(dead, Vec::<String>::new());
    assert!(followed > 10, "{followed} links found");
}

#[test]
fn every_page_is_in_the_index() {
    let docs = repository().join("docs");
    let index = std::fs::read_to_string(docs.join("README.md")).unwrap();
    let listed = links(&index);
    for page in markdown_in(&docs) {
        let name = page.strip_prefix(&docs).unwrap().to_str().unwrap().replace('\\', "/");
        assert!(name == "README.md" || listed.contains(&name), "{name} is not in docs/README.md");
    }
}

#[test]
fn the_readme_mentions_every_command() {
    let readme = std::fs::read_to_string(repository().join("README.md")).unwrap();
    let missing: Vec<String> = cli::command()
        .get_subcommands()
        .map(|command| command.get_name().to_owned())
        .filter(|name| !readme.contains(&format!("`{name}`")))
        .collect();
    assert_eq!(missing, Vec::<String>::new());
}

#[test]
fn the_example_of_a_world_is_one() {
    let page = std::fs::read_to_string(repository().join("docs/world.md")).unwrap();
    let example = page.split("```yaml\n").nth(1).and_then(|rest| rest.split("```").next()).unwrap();
    let world = world::document::read(&Source::new("docs/world.md", example), None).unwrap();
    assert_eq!(world.layers(), ["furniture", "walls"]);
    assert_eq!(world.warnings, Vec::<String>::new());
}

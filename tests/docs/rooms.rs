//! The table in DESIGN.md of the modules of `src/` ("rooms") and the modules that each of them uses
//! agrees with the paths in the source.

use super::markdown::{Page, root, same, spans};
use super::modules::{Modules, Segments};
use std::collections::{BTreeMap, BTreeSet};

/// For each module, the modules that it uses.
type Known = BTreeMap<String, BTreeSet<String>>;

/// The table of DESIGN.md: the first column lists modules, the second the modules that they use, by
/// themselves or as paths into them.
fn documented() -> Known {
    let rows = Page::read("DESIGN.md").rows("room");
    let rooms: BTreeSet<String> = rows.iter().flat_map(|row| spans(&row[0])).map(String::from).collect();
    let known = |cell: &str| {
        let named = spans(cell).into_iter().filter_map(|path| path.split("::").next()).map(String::from);
        named.filter(|room| rooms.contains(room)).collect::<BTreeSet<_>>()
    };
    let of_row = |row: &Vec<String>| {
        let rooms: Vec<String> = spans(&row[0]).into_iter().map(String::from).collect();
        rooms.into_iter().map(|room| (room, known(&row[1]))).collect::<Vec<_>>()
    };
    rows.iter().flat_map(of_row).collect()
}

/// The modules that each module uses according to the source.
fn found(modules: &Modules) -> Known {
    let mut known = Known::new();
    for place in modules.0.keys().filter(|place| !place.is_empty()) {
        let others = modules.known(place).into_iter().filter_map(|home| home.first().cloned());
        known.entry(place[0].clone()).or_default().extend(others.filter(|room| *room != place[0]));
    }
    known
}

/// A top-level module is a folder of the source, or a file beside `lib.rs` and `main.rs`.
#[test]
fn the_table_of_rooms_lists_every_room_of_the_source() {
    let entries = std::fs::read_dir(root().join("src")).expect("the source").map(|entry| entry.expect("readable"));
    let stems = entries.map(|entry| entry.path().file_stem().unwrap_or_default().to_string_lossy().into_owned());
    let rooms = stems.filter(|stem| stem != "lib" && stem != "main").collect();
    same(&documented().into_keys().collect(), &rooms);
}

#[test]
fn rooms_know_what_the_table_says_no_less_and_no_more() {
    let pairs = |known: Known| {
        let of_room =
            |(room, others): (String, BTreeSet<String>)| others.into_iter().map(move |o| format!("{room} -> {o}"));
        known.into_iter().flat_map(of_room).collect()
    };
    same(&pairs(documented()), &pairs(found(&Modules::read())));
}

/// The nodes of a graph that lie on a cycle, each with the nodes on the same cycles.
fn circles<T: Ord + Clone>(edges: &BTreeMap<T, BTreeSet<T>>) -> BTreeMap<T, BTreeSet<T>> {
    let reached = |from: &T| {
        let (mut seen, mut next) = (BTreeSet::new(), vec![from.clone()]);
        while let Some(at) = next.pop() {
            next.extend(edges.get(&at).into_iter().flatten().filter(|to| seen.insert((*to).clone())).cloned());
        }
        seen
    };
    let reach: BTreeMap<T, BTreeSet<T>> = edges.keys().map(|from| (from.clone(), reached(from))).collect();
    let back = |from: &T, to: &T| reach.get(to).is_some_and(|others| others.contains(from));
    let of = |from: &T| reach[from].iter().filter(|to| *to != from && back(from, to)).cloned().collect();
    reach
        .keys()
        .map(|from| (from.clone(), of(from)))
        .filter(|(_, others): &(T, BTreeSet<T>)| !others.is_empty())
        .collect()
}

#[test]
fn no_room_knows_itself_through_others() {
    assert_eq!(circles(&found(&Modules::read())), BTreeMap::new());
}

/// Modules in which a file still depends on itself through other files, mostly through `mod.rs`,
/// which defines what the files below it use and also calls them. A module that loses its last such
/// cycle must be removed from this list, and none may be added.
const CIRCULAR: [&str; 3] = ["cli", "lanes", "scheme"];

#[test]
fn files_of_a_room_do_not_know_themselves_through_others() {
    let modules = Modules::read();
    let mut edges: BTreeMap<Segments, BTreeSet<Segments>> = BTreeMap::new();
    for place in modules.0.keys().filter(|place| !place.is_empty()) {
        let others = modules.known(place).into_iter().filter(|home| home.first() == place.first());
        edges.insert(place.clone(), others.collect());
    }
    let circles = circles(&edges);
    for (file, others) in &circles {
        let others: Vec<String> = others.iter().map(|other| other.join("::")).collect();
        println!("{} and {}", file.join("::"), others.join(", "));
    }
    let rooms: BTreeSet<&str> = circles.keys().map(|file| file[0].as_str()).collect();
    assert_eq!(rooms, CIRCULAR.into(), "rooms with a circle of files; the output names the files");
}

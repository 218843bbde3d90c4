//! Pictures. They are drawn from the contents of a file, or from a path that is simulated again by
//! the same code.
//!
//! ```text
//! Subject     what a picture shows: a scenario, a run, a trade, sweeps, another data set
//!   -> FIGURES    one file each: what it takes from its subject, and its layout
//!        Axis, Panel   numbers to positions; curves, bands, bars, marks, notes without overlap
//!   -> Sheet      a legend above panels that are aligned below each other
//!   -> Drawing    a picture as data (kit): one figure or panel (only), or all on a page (page)
//!   -> svg, png, pdf
//! ```
//!
//! A new figure is a file with a function `draw` in it, and its row in [`RUN`], [`TRADE`] or [`SWEEP`]. Figures of other
//! data sets are in the crates that write them, and made of the same parts.

mod axis;
mod density;
mod drift;
mod fan;
mod kit;
mod laws;
mod legend;
mod mark;
mod only;
mod overview;
mod page;
mod panel;
mod passages;
mod path;
mod section;
mod sheet;
mod spectrum;
mod steps;
mod sticks;
mod sub_phases;
mod subject;
mod sweep;
mod theme;
mod tornado;
mod trace;
mod trade;
mod words;

pub use kit::{Drawing, escaped, pdf, png, svg};
pub use only::Only;
pub use page::{NoPage, draw, page};
pub use subject::{Absent, DrawnPath, Figure, Subject};
pub use theme::{COLUMN, Palette, Style, THIN, Theme};

// Building blocks of figures.
pub use axis::{Axis, range_of};
pub use kit::{Colour, Label, Stroke};
pub use legend::LegendEntry;
pub use mark::Mark;
pub use panel::Panel;
pub use sheet::{Sheet, sheet, solid};

/// The figures of a run, in the order in which a page shows them. Those of a path need no run.
pub const RUN: &[Figure] = &[
    Figure {
        name: "path",
        draws: path::draw,
    },
    Figure {
        name: "fan",
        draws: fan::draw,
    },
    Figure {
        name: "sticks",
        draws: sticks::draw,
    },
    Figure {
        name: "sub-phases",
        draws: sub_phases::draw,
    },
    Figure {
        name: "drift",
        draws: drift::draw,
    },
    Figure {
        name: "laws",
        draws: laws::draw,
    },
    Figure {
        name: "passages",
        draws: passages::draw,
    },
    Figure {
        name: "density",
        draws: density::draw,
    },
    Figure {
        name: "spectrum",
        draws: spectrum::draw,
    },
    Figure {
        name: "overview",
        draws: overview::draw,
    },
];

/// The figure of a trade.
pub const TRADE: &[Figure] = &[Figure {
    name: "trade",
    draws: trade::draw,
}];

/// The figures of a sweep, in the order in which a page shows them.
pub const SWEEP: &[Figure] = &[
    Figure {
        name: "sweep",
        draws: sweep::draw,
    },
    Figure {
        name: "tornado",
        draws: tornado::draw,
    },
    Figure {
        name: "section",
        draws: section::draw,
    },
];

#[cfg(test)]
mod tests {
    use super::*;
    use stickslip::config::Override;
    use stickslip::engine::Run;
    use stickslip::scenario::Scenario;

    /// Draws every figure of a run but its path, and returns their names, numbers of panels and words.
    fn figures(scenario: &Scenario) -> Vec<(&'static str, usize, String)> {
        let run = Run::of(scenario).without_bias();
        let summary = run.simulate().expect("no sink").summary;
        let path = DrawnPath {
            scenario,
            number: 0,
            from: 0.0,
        };
        let run = Subject::Run {
            scenario,
            summary: &summary,
            path,
        };
        let draw = |figure: &Figure| {
            let sheet = (figure.draws)(&run, &Style::default()).ok()?;
            let mut words = String::new();
            gather(&sheet.alone(&Style::default()).items, &mut words);
            Some((figure.name, sheet.panel_count(), words))
        };
        RUN[1..].iter().filter_map(draw).collect()
    }

    /// The number of panels and the words of one of these figures.
    fn figure(scenario: &Scenario, name: &str) -> (usize, String) {
        let drawn = figures(scenario);
        let (_, panels, words) = drawn
            .into_iter()
            .find(|drawn| drawn.0 == name)
            .expect("drawn");
        (panels, words)
    }

    fn gather(items: &[kit::Item], out: &mut String) {
        for item in items {
            match item {
                kit::Item::Words { label, .. } => *out += &format!("{}\n", label.words()),
                kit::Item::Clipped { items, .. } | kit::Item::Moved { items, .. } => {
                    gather(items, out)
                }
                kit::Item::Shape { .. } => {}
            }
        }
    }

    #[test]
    fn every_figure_states_bias_and_missing_limit() {
        let mut scenario = Scenario::shipped("equal-friction").expect("shipped");
        scenario.ensemble.paths = 200;
        scenario.time.end = 120.0;
        scenario.units.length = "m".into();
        scenario.units.time = "s".into();
        let record = &mut scenario.record;
        (record.laws, record.density, record.spectrum) = (true, true, true);
        let drawn = figures(&scenario);
        let names: Vec<&str> = drawn.iter().map(|(name, ..)| *name).collect();
        assert_eq!(names.len(), RUN.len() - 2, "{names:?}");
        for (name, _, words) in &drawn {
            assert!(words.contains("including the bias"), "{name}: {words}");
            let counts = ["sticks", "sub-phases", "laws", "overview"].contains(name);
            assert_eq!(words.contains("without a"), counts, "{name}: {words}");
        }
        let drift = drawn.iter().find(|(name, ..)| *name == "drift");
        assert!(drift.is_some_and(|(.., words)| words.contains("m/s\n")));
    }

    #[test]
    fn pictures_of_one_path_show_no_intervals() {
        let shaw = Scenario::shipped("shaw").expect("shipped");
        let drawn = figures(&shaw);
        assert!(drawn.len() > 3);
        for (name, _, words) in &drawn {
            assert!(
                !words.contains("95 %") || name == &"overview",
                "{name}: {words}"
            );
            assert!(!words.contains("static"), "{name}: {words}");
        }
        let of = |name: &str| drawn.iter().find(|one| one.0 == name).expect("drawn");
        assert_eq!(of("drift").1, 1);
        assert!(of("fan").2.contains("the one path") && !of("fan").2.contains("median"));
    }

    /// The picture of a path of a scenario that is read from this text, and its words.
    fn path(text: &str) -> (Sheet, String) {
        let scenario = Scenario::parse("text", text, &[]).expect("sound");
        let path = DrawnPath {
            scenario: &scenario,
            number: 0,
            from: 0.0,
        };
        let sheet = (RUN[0].draws)(&Subject::Path(path), &Style::default()).expect("drawn");
        let mut words = String::new();
        gather(&sheet.alone(&Style::default()).items, &mut words);
        (sheet, words)
    }

    const REST: &str = "oscillator = { mass = 1, stiffness = 1, dilatation = 1 }\n\
        friction = { static = 1.2, dynamic = 1.0 }\ninitial.displacement = 0\n\
        scheme.kind = \"event-driven\"\nensemble.paths = 1\ntime.end = 60\n";

    /// A body that stays at x = 0, with and without labels of units, and for many days.
    #[test]
    fn a_body_at_rest_is_drawn() {
        let days = REST.replace("time.end = 60", "time.end = 1e7\nunits.time = \"s\"");
        for (text, unit) in [(REST, "time t\n"), (&days, "time t (d)\n")] {
            let (sheet, words) = path(text);
            assert!(sheet.panel_count() >= 2 && words.contains(unit), "{words}");
            assert!(
                words.contains("stick\n") && !words.contains("slip"),
                "{words}"
            );
        }
    }

    /// The force of white noise would fill the phase plane, which is left out; that of the paper's
    /// noise is drawn.
    #[test]
    fn white_noise_does_not_fill_the_phase_plane() {
        let belt = include_str!("../../../scenarios/belt.toml");
        let set = [
            "oscillator.stiffness=0",
            "temperature.trend=0",
            "temperature.noise.intensity=1",
            "friction.static=1",
            "friction.dynamic=1",
            "temperature.noise.relaxation_rate=100",
            "temperature.noise.diffusion=100",
            "time.end=40",
        ];
        let set = set.map(|set| Override::set(set).expect("well formed"));
        let free = Scenario::parse("belt", belt, &set).expect("sound");
        let white = path(&free.to_toml()).1;
        assert!(!white.contains("longest completed slip"), "{white}");
        assert!(
            white.contains("too close for velocity and forces"),
            "{white}"
        );
    }

    #[test]
    fn the_caption_of_the_phase_plane_names_completed_slips() {
        let rho025 = include_str!("../../../scenarios/rho025.toml");
        assert!(path(rho025).1.contains("longest completed slip bold"));
    }

    #[test]
    fn sticks_of_one_length_are_shown_by_their_quantiles() {
        let shaw = Scenario::shipped("shaw").expect("shipped");
        let (panels, words) = figure(&shaw, "sticks");
        assert!(panels == 1 && words.contains("quantile"), "{words}");
    }
}

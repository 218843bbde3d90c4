//! Reading the file of a sweep, finished or not.

use crate::dataset::StoredSweep;
use crate::dataset::sweep::{self, SWEEP_FORMAT_NAME, SWEEP_FORMAT_VERSION, name, program};
use crate::engine::Provenance;
use crate::store::StoreError;
use crate::store::reader::read_kind;
use crate::study::sweep::{Design, SweepQuestion};
use std::path::Path;

/// The first difference between a stored sweep and this question, in words; `None` if there is
/// none.
pub(super) fn difference(stored: &StoredSweep, header: &Provenance, question: &SweepQuestion) -> Option<String> {
    let Provenance { program_version, git_hash, generator, block_size, .. } = header;
    let mine = program(program_version, git_hash, generator, *block_size);
    let parts = |design: &Design| -> Vec<String> {
        let axes = design.axes().iter();
        let mut parts: Vec<String> =
            axes.map(|axis| format!("{} = {} at {:?}", axis.name, axis.key, axis.values)).collect();
        if let Design::Star { keys, relative_step } = design {
            parts.extend(keys.iter().map(|(key, value)| format!("{key} = {value:?}")));
            parts.push(format!("relative step {relative_step:?}"));
        }
        parts.push(name(design).to_string());
        parts
    };
    let bias = |with_bias| if with_bias { "estimates the bias of the step" } else { "leaves out the bias of the step" };
    let compared = [
        (lines(&stored.scenario_text), lines(&header.scenario_text)),
        (parts(&stored.design), parts(&question.design)),
        (vec![format!("{} seeds", stored.seeds.name())], vec![format!("{} seeds", question.seeds.name())]),
        (vec![bias(stored.with_bias).to_string()], vec![bias(question.with_bias).to_string()]),
        (vec![stored.program.clone()], vec![mine]),
    ];
    compared.iter().find_map(|(theirs, mine)| {
        let most = theirs.len().max(mine.len());
        let at = |list: &[String], i: usize| list.get(i).cloned().unwrap_or_else(|| "nothing".into());
        let i = (0..most).find(|&i| theirs.get(i) != mine.get(i))?;
        Some(format!("it has `{}`, and this sweep `{}`", at(theirs, i), at(mine, i)))
    })
}

/// The lines of a text without comments and empty lines.
fn lines(text: &str) -> Vec<String> {
    let said = text.lines().map(|line| line.split("  #").next().unwrap_or("").trim().to_string());
    said.filter(|line| !line.is_empty()).collect()
}

/// Read the file of a sweep. A file that is not one, has another format or is damaged is an error.
pub fn read_sweep(path: &Path) -> Result<StoredSweep, StoreError> {
    read_kind(path, (SWEEP_FORMAT_NAME, SWEEP_FORMAT_VERSION), |path| StoreError::NotASweep { path }, sweep::read)
}

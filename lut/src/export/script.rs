//! Scripts that run the shards of a plan.

use std::path::Path;

use crate::error::Error;
use crate::export::escape::{shell_word, slurm_value};

/// The version of kufe, as a comment.
const MARK: &str = concat!("# kufe ", env!("CARGO_PKG_VERSION"), "\n");

/// A Slurm job array, one shard per task: `sbatch --wait slurm.sh`.
///
/// Submitting the script again repeats failed tasks; finished points are not solved again.
///
/// # Errors
/// [`Error::Invalid`] for a path with characters that a script cannot contain.
pub fn slurm_script(kufe: &Path, plan: &Path, shards: usize) -> Result<String, Error> {
    let folder = slurm_value(plan)?;
    let folder = folder.strip_suffix('"').unwrap_or(&folder);
    let log = format!("{folder}/slurm-%A_%a.log\"");
    Ok(format!(
        "#!/bin/bash\n\
         {MARK}\
         #SBATCH --job-name=kufe-lut\n\
         #SBATCH --array=1-{shards}\n\
         #SBATCH --cpus-per-task=1\n\
         #SBATCH --output={log}\n\
         # Submit again to run what failed; finished points are not solved again.\n\
         exec {} lut run {} --shard \"$SLURM_ARRAY_TASK_ID/{shards}\" --threads \"${{SLURM_CPUS_PER_TASK:-1}}\"\n",
        shell_word(kufe)?,
        shell_word(plan)?,
    ))
}

/// A script for GNU parallel on this machine, `sh parallel.sh`; running it again repeats failed
/// shards.
///
/// # Errors
/// [`Error::Invalid`] for a path with characters that a script cannot contain.
pub fn parallel_script(kufe: &Path, plan: &Path, shards: usize) -> Result<String, Error> {
    // GNU parallel passes its command to a shell. Paths are passed as variables, which this shell
    // does not parse again.
    Ok(format!(
        "#!/bin/sh\n\
         {MARK}\
         # Run again to run what failed; finished points are not solved again.\n\
         KUFE={}\n\
         PLAN={}\n\
         export KUFE PLAN\n\
         exec parallel --joblog \"$PLAN/parallel.log\" --halt never \
         '\"$KUFE\" lut run \"$PLAN\" --shard {{}}/{shards} --threads 1' ::: $(seq 1 {shards})\n",
        shell_word(kufe)?,
        shell_word(plan)?,
    ))
}

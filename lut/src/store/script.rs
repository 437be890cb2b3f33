//! Scripts that run a plan's shards.

use std::path::Path;

/// Which kufe wrote it.
const MARK: &str = concat!("# kufe ", env!("CARGO_PKG_VERSION"), "\n");

/// A Slurm job array, one shard a task: `sbatch --wait slurm.sh`.
///
/// Tasks that fail are run again by submitting the script again: finished points are kept.
pub fn slurm(kufe: &Path, plan: &Path, shards: usize) -> String {
    format!(
        "#!/bin/bash\n\
         {MARK}\
         #SBATCH --job-name=kufe-lut\n\
         #SBATCH --array=1-{shards}\n\
         #SBATCH --cpus-per-task=1\n\
         #SBATCH --output={}/slurm-%A_%a.log\n\
         # Submit again to run what failed; finished points are not solved again.\n\
         exec {} lut run {} --shard \"$SLURM_ARRAY_TASK_ID/{shards}\" --threads \"${{SLURM_CPUS_PER_TASK:-1}}\"\n",
        plan.display(),
        quoted(kufe),
        quoted(plan),
    )
}

/// The same with GNU parallel, on this machine: `sh parallel.sh`, again to run what failed.
pub fn parallel(kufe: &Path, plan: &Path, shards: usize) -> String {
    let plan_text = quoted(plan);
    format!(
        "#!/bin/sh\n\
         {MARK}\
         # Run again to run what failed; finished points are not solved again.\n\
         exec parallel --joblog {} --halt never {} lut run {plan_text} --shard '{{}}/{shards}' --threads 1 ::: $(seq 1 {shards})\n",
        quoted(&plan.join("parallel.log")),
        quoted(kufe),
    )
}

/// A path as one word of a POSIX shell.
fn quoted(path: &Path) -> String {
    format!("'{}'", path.display().to_string().replace('\'', r"'\''"))
}

//! `kufe simulate`: a sled driven down a track, recorded like a measured run.

use kufe::jobs::Failure;

use crate::output::global::Global;
use crate::runs::simulate::args::Args;
use crate::runs::simulate::drive::drive;
use crate::runs::simulate::replay::replay_run;
use crate::runs::simulate::sample::sample;

/// Simulates and writes.
///
/// # Errors
/// [`Failure::BadInput`] with file and place, [`Failure::Usage`] for options out of range.
pub fn run(args: &Args, global: &Global) -> Result<(), Failure> {
    match (&args.sample_data, &args.model, &args.track) {
        (None, Some(model), Some(track)) if args.replay.is_some() => {
            replay_run(args, model, track, global)
        }
        (Some(folder), model, _) => sample(args, folder, model.as_deref(), global),
        (None, Some(model), Some(track)) => drive(args, model, track, global),
        _ => Err(Failure::Usage(
            "a model and a track are needed, or --sample-data".to_string(),
        )),
    }
}

//! `--gpu`: the graphics processor that a contact is solved on.

use kufe::jobs::Failure;
use kufe_contact::Options;

use crate::output::global::Global;

/// The solver's options, with the best graphics processor where it is asked for.
#[cfg(feature = "gpu")]
pub fn options(gpu: bool, global: &Global) -> Result<Options, Failure> {
    if !gpu {
        return Ok(Options::default());
    }
    let device =
        kufe_fem::gpu::Device::open().map_err(|error| Failure::Usage(format!("--gpu: {error}")))?;
    if device.is_software() {
        eprintln!(
            "kufe: warning: --gpu: {} is software on the main processor",
            device.name()
        );
    } else if global.verbose {
        eprintln!("kufe: solving on {}", device.name());
    }
    Ok(Options {
        device: Some(std::sync::Arc::new(device)),
        ..Options::default()
    })
}

/// As built without the feature.
#[cfg(not(feature = "gpu"))]
pub fn options(gpu: bool, _: &Global) -> Result<Options, Failure> {
    if gpu {
        return Err(Failure::Usage(
            "--gpu: this kufe was built without the feature gpu; from the source tree: \
             cargo install --path cli --features gpu"
                .into(),
        ));
    }
    Ok(Options::default())
}

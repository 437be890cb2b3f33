//! Elimination along z on the device.

use crate::error::Error;
use crate::gpu::device::open::Device;
use crate::gpu::device::work::Work;
use crate::gpu::units::Units;
use crate::precondition::elimination::Elimination;

/// Threads of a group, as the shader has them.
const GROUP: usize = 64;

/// The forward and the backward pass over the modal values of each component.
pub(super) struct Passes {
    pub gather: [Work; 3],
    pub spread: [Work; 3],
}

/// Passes over `modal`, which holds component after component, plane by plane in the order of elimination.
pub(super) fn passes(
    device: &Device,
    eliminations: [&Elimination; 3],
    units: &Units,
    modal: &wgpu::Buffer,
) -> Result<Passes, Error> {
    // T goes with modulus / length, M with length, and the shift with modulus / length^2.
    let row = units.modulus / units.length;
    let shift_unit = row / units.length;
    let mut inverse: Vec<f32> = Vec::new();
    let mut shifts: Vec<f32> = Vec::new();
    let mut couplings: Vec<f32> = Vec::new();
    let mut places = Vec::new();
    for of in eliminations {
        let (pairs, planes) = (of.shift.len(), of.planes.len());
        places.push([
            pairs,
            planes,
            inverse.len(),
            shifts.len(),
            couplings.len() / 2,
        ]);
        inverse.extend(of.inverse_pivots.iter().map(|v| (v * row) as f32));
        shifts.extend(of.shift.iter().map(|v| (v / shift_unit) as f32));
        let couplings_of = of.coupling.iter();
        couplings
            .extend(couplings_of.flat_map(|[k, m]| [k / row, m / units.length].map(|v| v as f32)));
    }
    let inverse = device.holding("pivots", &inverse)?;
    let shifts = device.holding("shifts", &shifts)?;
    let couplings = device.holding("couplings", &couplings)?;
    let source = include_str!("elimination.wgsl");
    let pass = |entry: &'static str| -> Result<[Work; 3], Error> {
        let kernel = device.kernel(source, entry);
        let work = |place: [usize; 5]| {
            let column = device.parameters("column", &place.map(|v| v as u32));
            let buffers = [
                (0, &column),
                (1, &inverse),
                (2, &shifts),
                (3, &couplings),
                (4, modal),
            ];
            device.work(&kernel, &buffers, [place[0].div_ceil(GROUP), 1, 1])
        };
        Ok([work(places[0])?, work(places[1])?, work(places[2])?])
    };
    Ok(Passes {
        gather: pass("gather")?,
        spread: pass("spread")?,
    })
}

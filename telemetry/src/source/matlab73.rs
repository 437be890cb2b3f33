//! MATLAB v7.3 files, which are HDF5: vectors, and vectors in structs by `struct.field`.

use hdf5_pure::{DType, Dataset, File, Group};

use crate::error::Error;
use crate::source::log::{Channel, Log};
use crate::source::unpacked::{most_unpacked, numbers_of};

/// Structs within structs that are looked into.
const DEPTH: usize = 6;

/// Reads a file; of the vectors only those `wanted` by name, or all of numbers.
///
/// # Errors
/// [`Error::File`] where it is no HDF5, or a vector that is wanted cannot be read.
pub fn read_matlab73(bytes: Vec<u8>, wanted: Option<&[&str]>, file: &str) -> Result<Log, Error> {
    let told = |error: hdf5_pure::Error| Error::file(file, error);
    let most = most_unpacked(bytes.len());
    let hdf = File::from_bytes(bytes).map_err(told)?;
    let mut vectors = Vec::new();
    collect(&hdf.root(), "", DEPTH, &mut vectors).map_err(told)?;
    let mut log = Log::default();
    for (name, _) in &vectors {
        log.channels.push(Channel {
            name: name.clone(),
            unit: None,
            clock: None,
            values: Vec::new(),
        });
    }
    let mut places: Vec<usize> = (0..vectors.len()).collect();
    if let Some(names) = wanted {
        places = names
            .iter()
            .map(|name| log.find(name, file))
            .collect::<Result<_, _>>()?;
    }
    for place in places {
        let shape = vectors[place].1.shape().map_err(told)?;
        if numbers_of(&shape) > most {
            let name = &vectors[place].0;
            let reason = format!("{name}: more numbers than a file of this size can hold");
            return Err(Error::file(file, reason));
        }
        log.channels[place].values = numbers(&vectors[place].1).map_err(told)?;
    }
    Ok(log)
}

/// Vectors of numbers below a group, by their names.
fn collect(
    group: &Group,
    before: &str,
    depth: usize,
    vectors: &mut Vec<(String, Dataset)>,
) -> Result<(), hdf5_pure::Error> {
    for name in group.datasets()? {
        let data = group.dataset(&name)?;
        let shape = data.shape()?;
        let vector = numbers_of(&shape) > 1 && shape.iter().filter(|n| **n != 1).count() == 1;
        let number = !matches!(
            data.dtype()?,
            DType::String
                | DType::VariableLengthString
                | DType::ObjectReference
                | DType::Compound(_)
                | DType::Other(_)
                | DType::Array(..)
        );
        if vector && number {
            vectors.push((format!("{before}{name}"), data));
        }
    }
    for name in group.groups()? {
        // #refs# and #subsystem# are MATLAB's own.
        if depth > 0 && !name.starts_with('#') {
            collect(
                &group.group(&name)?,
                &format!("{before}{name}."),
                depth - 1,
                vectors,
            )?;
        }
    }
    Ok(())
}

fn numbers(data: &Dataset) -> Result<Vec<f64>, hdf5_pure::Error> {
    let from = |values: Vec<i64>| values.into_iter().map(|v| v as f64).collect();
    Ok(match data.dtype()? {
        DType::F32 => data.read_f32()?.into_iter().map(f64::from).collect(),
        DType::I8 => data.read_i8()?.into_iter().map(f64::from).collect(),
        DType::I16 => data.read_i16()?.into_iter().map(f64::from).collect(),
        DType::I32 => data.read_i32()?.into_iter().map(f64::from).collect(),
        DType::I64 => from(data.read_i64()?),
        DType::U8 => data.read_u8()?.into_iter().map(f64::from).collect(),
        DType::U16 => data.read_u16()?.into_iter().map(f64::from).collect(),
        DType::U32 => data.read_u32()?.into_iter().map(f64::from).collect(),
        DType::U64 => data.read_u64()?.into_iter().map(|v| v as f64).collect(),
        _ => data.read_f64()?,
    })
}

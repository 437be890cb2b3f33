//! Which processor computes, and how its failures become errors.

use std::collections::HashMap;
use std::sync::{Arc, Mutex, PoisonError};

use crate::error::Error;

/// An open graphics processor.
pub struct Device {
    pub(super) device: wgpu::Device,
    pub(super) queue: wgpu::Queue,
    pub(super) limits: wgpu::Limits,
    name: String,
    software: bool,
    failure: Failure,
    /// Shaders are translated once for all solves.
    pub(super) kernels: Mutex<HashMap<&'static str, wgpu::ComputePipeline>>,
}

/// What went wrong first.
type Failure = Arc<Mutex<Option<String>>>;

impl Device {
    /// Opens the best adapter of this machine: a card of its own before one in the processor, before software.
    ///
    /// # Errors
    /// [`Error::NoAdapter`] where there is none, [`Error::Device`] where it cannot be opened.
    pub fn open() -> Result<Self, Error> {
        let instance = wgpu::Instance::new(wgpu::InstanceDescriptor {
            backends: wgpu::Backends::VULKAN | wgpu::Backends::METAL | wgpu::Backends::DX12,
            flags: wgpu::InstanceFlags::empty(),
            ..wgpu::InstanceDescriptor::new_without_display_handle()
        });
        let adapters = pollster::block_on(instance.enumerate_adapters(wgpu::Backends::all()));
        let adapter = adapters
            .into_iter()
            .min_by_key(|adapter| rank(adapter.get_info().device_type))
            .ok_or(Error::NoAdapter)?;
        let info = adapter.get_info();
        let limits = adapter.limits();
        let opened = adapter.request_device(&wgpu::DeviceDescriptor {
            required_limits: limits.clone(),
            ..wgpu::DeviceDescriptor::default()
        });
        let (device, queue) = pollster::block_on(opened).map_err(|error| Error::Device {
            reason: error.to_string(),
        })?;
        let failure = Failure::default();
        let (uncaptured, lost) = (failure.clone(), failure.clone());
        device.on_uncaptured_error(Arc::new(move |error| keep(&uncaptured, error.to_string())));
        device.set_device_lost_callback(move |_, reason| {
            keep(&lost, format!("the device was lost: {reason}"));
        });
        Ok(Device {
            device,
            queue,
            limits,
            name: [info.name, info.backend.to_string(), info.driver_info].join(", "),
            software: info.device_type == wgpu::DeviceType::Cpu,
            failure,
            kernels: Mutex::default(),
        })
    }

    /// The adapter, the interface it is used by, and its driver.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Whether the adapter is the main processor in disguise.
    pub fn is_software(&self) -> bool {
        self.software
    }

    /// The first failure since the device was opened.
    ///
    /// # Errors
    /// [`Error::Device`].
    pub(in crate::gpu) fn check(&self) -> Result<(), Error> {
        let failure = self.failure.lock().unwrap_or_else(PoisonError::into_inner);
        match &*failure {
            Some(reason) => Err(Error::Device {
                reason: reason.clone(),
            }),
            None => Ok(()),
        }
    }
}

fn keep(failure: &Failure, reason: String) {
    let mut first = failure.lock().unwrap_or_else(PoisonError::into_inner);
    first.get_or_insert(reason);
}

fn rank(kind: wgpu::DeviceType) -> usize {
    match kind {
        wgpu::DeviceType::DiscreteGpu => 0,
        wgpu::DeviceType::IntegratedGpu => 1,
        wgpu::DeviceType::VirtualGpu => 2,
        wgpu::DeviceType::Other => 3,
        wgpu::DeviceType::Cpu => 4,
    }
}

//! Numbers to the device and back.

use wgpu::BufferUsages;

use crate::error::Error;
use crate::gpu::device::open::Device;

/// Bytes of a number.
const NUMBER: u64 = 4;

impl Device {
    /// Room for so many numbers, zeros to begin with.
    ///
    /// # Errors
    /// [`Error::DeviceLimit`] where one buffer of the device cannot hold them.
    pub(in crate::gpu) fn room(
        &self,
        what: &'static str,
        numbers: usize,
    ) -> Result<wgpu::Buffer, Error> {
        let bytes = NUMBER * numbers.max(1) as u64;
        let limit = self
            .limits
            .max_storage_buffer_binding_size
            .min(self.limits.max_buffer_size);
        // Shaders count numbers in 32 bits.
        let limit = limit.min(NUMBER * u64::from(u32::MAX / 2));
        if bytes > limit {
            return Err(Error::DeviceLimit {
                what,
                needed: bytes,
                limit,
            });
        }
        let usage = BufferUsages::STORAGE | BufferUsages::COPY_SRC | BufferUsages::COPY_DST;
        Ok(self.buffer(what, bytes, usage))
    }

    /// A buffer that holds `values`.
    pub(in crate::gpu) fn holding(
        &self,
        what: &'static str,
        values: &[f32],
    ) -> Result<wgpu::Buffer, Error> {
        let buffer = self.room(what, values.len())?;
        self.write(&buffer, 0, values);
        Ok(buffer)
    }

    /// Whole numbers that a kernel takes as its parameters.
    pub(in crate::gpu) fn parameters(&self, what: &'static str, values: &[u32]) -> wgpu::Buffer {
        let mut values = values.to_vec();
        values.resize(values.len().next_multiple_of(4), 0);
        let usage = BufferUsages::UNIFORM | BufferUsages::COPY_DST;
        let buffer = self.buffer(what, NUMBER * values.len() as u64, usage);
        let bytes = bytemuck::cast_slice(&values);
        self.queue.write_buffer(&buffer, 0, bytes);
        buffer
    }

    fn buffer(&self, what: &'static str, size: u64, usage: BufferUsages) -> wgpu::Buffer {
        self.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some(what),
            size,
            usage,
            mapped_at_creation: false,
        })
    }

    /// Writes `values` from number `first` of a buffer on.
    pub(in crate::gpu) fn write(&self, buffer: &wgpu::Buffer, first: usize, values: &[f32]) {
        let bytes = bytemuck::cast_slice(values);
        self.queue
            .write_buffer(buffer, NUMBER * first as u64, bytes);
    }

    /// Fills buffers with zeros.
    pub(in crate::gpu) fn clear<const N: usize>(&self, buffers: [&wgpu::Buffer; N]) {
        let mut encoder = self.device.create_command_encoder(&Default::default());
        for buffer in buffers {
            encoder.clear_buffer(buffer, 0, None);
        }
        self.queue.submit([encoder.finish()]);
    }

    /// Waits for all work and reads what begins at a place of each buffer, to fill the slices.
    ///
    /// # Errors
    /// [`Error::Device`] where anything went wrong since the device was opened.
    pub(in crate::gpu) fn read(
        &self,
        parts: &mut [(&wgpu::Buffer, usize, &mut [f32])],
    ) -> Result<(), Error> {
        let size = parts.iter().map(|part| NUMBER * part.2.len() as u64).sum();
        let usage = BufferUsages::MAP_READ | BufferUsages::COPY_DST;
        let landing = self.buffer("landing", size, usage);
        let mut encoder = self.device.create_command_encoder(&Default::default());
        let mut place = 0;
        for (buffer, first, values) in parts.iter() {
            let length = NUMBER * values.len() as u64;
            encoder.copy_buffer_to_buffer(buffer, NUMBER * *first as u64, &landing, place, length);
            place += length;
        }
        self.queue.submit([encoder.finish()]);
        landing.map_async(wgpu::MapMode::Read, .., |_| {});
        let polled = self.device.poll(wgpu::PollType::wait_indefinitely());
        self.check()?;
        let failed = |reason: String| Error::Device { reason };
        polled.map_err(|error| failed(error.to_string()))?;
        let view = landing
            .get_mapped_range(..)
            .map_err(|error| failed(error.to_string()))?;
        let mut all: &[f32] = bytemuck::cast_slice(&view);
        for (_, _, values) in parts.iter_mut() {
            let (own, rest) = all.split_at(values.len());
            values.copy_from_slice(own);
            all = rest;
        }
        Ok(())
    }
}

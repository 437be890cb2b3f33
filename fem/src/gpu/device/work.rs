//! Kernels made ready: shader, buffers and number of groups.

use std::sync::PoisonError;

use crate::error::Error;
use crate::gpu::device::open::Device;

/// One kernel over given buffers.
pub(in crate::gpu) struct Work {
    pipeline: wgpu::ComputePipeline,
    bindings: wgpu::BindGroup,
    groups: [u32; 3],
}

impl Device {
    /// The kernel `entry` of a shader; names are the kernels' own, whatever the shader.
    pub(in crate::gpu) fn kernel(
        &self,
        source: &str,
        entry: &'static str,
    ) -> wgpu::ComputePipeline {
        let mut kernels = self.kernels.lock().unwrap_or_else(PoisonError::into_inner);
        let kernel = kernels
            .entry(entry)
            .or_insert_with(|| self.translate(source, entry));
        kernel.clone()
    }

    fn translate(&self, source: &str, entry: &'static str) -> wgpu::ComputePipeline {
        let module = self
            .device
            .create_shader_module(wgpu::ShaderModuleDescriptor {
                label: Some(entry),
                source: wgpu::ShaderSource::Wgsl(source.into()),
            });
        self.device
            .create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
                label: Some(entry),
                layout: None,
                module: &module,
                entry_point: Some(entry),
                compilation_options: Default::default(),
                cache: None,
            })
    }

    /// That kernel over `buffers`, by their bindings.
    ///
    /// # Errors
    /// [`Error::DeviceLimit`] where the device does not start so many groups at once.
    pub(in crate::gpu) fn work(
        &self,
        kernel: &wgpu::ComputePipeline,
        buffers: &[(u32, &wgpu::Buffer)],
        groups: [usize; 3],
    ) -> Result<Work, Error> {
        let limit = u64::from(self.limits.max_compute_workgroups_per_dimension);
        if let Some(&needed) = groups.iter().find(|groups| **groups as u64 > limit) {
            return Err(Error::DeviceLimit {
                what: "groups of a kernel",
                needed: needed as u64,
                limit,
            });
        }
        let entries: Vec<wgpu::BindGroupEntry> = buffers
            .iter()
            .map(|&(binding, buffer)| wgpu::BindGroupEntry {
                binding,
                resource: buffer.as_entire_binding(),
            })
            .collect();
        let bindings = self.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: None,
            layout: &kernel.get_bind_group_layout(0),
            entries: &entries,
        });
        Ok(Work {
            pipeline: kernel.clone(),
            bindings,
            groups: groups.map(|groups| groups as u32),
        })
    }

    /// Hands kernels to the device, one after the other, `times` times; returns before they are done.
    pub(in crate::gpu) fn start<'a>(
        &self,
        works: impl Iterator<Item = &'a Work> + Clone,
        times: usize,
    ) {
        let mut encoder = self.device.create_command_encoder(&Default::default());
        let mut pass = encoder.begin_compute_pass(&Default::default());
        for _ in 0..times {
            for work in works.clone() {
                let [x, y, z] = work.groups;
                pass.set_pipeline(&work.pipeline);
                pass.set_bind_group(0, &work.bindings, &[]);
                pass.dispatch_workgroups(x, y, z);
            }
        }
        drop(pass);
        self.queue.submit([encoder.finish()]);
    }
}

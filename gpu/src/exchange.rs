//! Exchange with other devices that share the grid.

use crate::device::{DeviceError, TransformPart};
use crate::evaluation::MODE_THREADS;
use crate::far_field::SplitFarField;
use crate::share::{SUMS, StencilSums};
use bytemuck::Zeroable;
use std::ops::Range;

impl SplitFarField {
    /// Modes of whole columns along z, by planes from the values on the grid.
    pub(crate) fn columns_from_grid(&mut self) -> Result<(), DeviceError> {
        self.transform(true, TransformPart::Planes)?;
        self.exchange_modes(["planes", "columns"])
    }

    /// Values on the grid from modes that have been transformed along z.
    pub(crate) fn grid_from_columns(&mut self) -> Result<(), DeviceError> {
        self.exchange_modes(["columns", "planes"])?;
        self.transform(false, TransformPart::Planes)
    }

    /// Exchanges modes with other devices, from one layout to another: those that leave and arrive are in the memory of
    /// the field.
    fn exchange_modes(&mut self, [from, to]: [&str; 2]) -> Result<(), DeviceError> {
        let Some(peers) = self.peers.clone() else { return Ok(()) };
        let share = self.tables.share.clone();
        let (own_planes, own_modes) = (share.own_planes().len(), share.own_modes().len());
        // Three complex values for each mode along x.
        let row_words = 6 * (self.tables.grid[0] / 2 + 1) * self.tables.numbers.size() / size_of::<u64>();
        let of_planes = share.places(&share.modes, row_words * own_planes);
        let of_columns = share.places(&share.planes, row_words * own_modes);
        let is_forward = from == "planes";
        let (leaving, arriving) = if is_forward { (of_planes, of_columns) } else { (of_columns, of_planes) };
        let kept = self.task.field + (size_of::<u64>() * row_words * own_planes * own_modes) as u64;
        let total = |places: &[Range<usize>]| places.iter().map(Range::len).sum();
        let [mut sent, mut received] = [vec![0_u64; total(&leaving)], vec![0_u64; total(&arriving)]];
        self.move_modes("pack", from)?;
        if !sent.is_empty() {
            self.device.download(kept, bytemuck::cast_slice_mut(&mut sent))?;
        }
        peers.exchange((&sent, &leaving), (&mut received, &arriving));
        self.device.upload(kept, bytemuck::cast_slice(&received))?;
        self.move_modes("unpack", to)
    }

    /// Runs a kernel over the modes in a layout.
    fn move_modes(&mut self, kernel: &str, layout: &str) -> Result<(), DeviceError> {
        let modes = if layout == "planes" { self.tables.modes_of_planes() } else { self.tables.modes() };
        let name = format!("{kernel}_{layout}_{}", self.tables.numbers.suffix());
        self.launch(&name, modes.div_ceil(MODE_THREADS), MODE_THREADS)
    }

    /// Adds to the sums of the interpolation those that other devices have found in their planes.
    pub(crate) fn collect_sums(&mut self) -> Result<(), DeviceError> {
        let Some(peers) = self.peers.clone() else { return Ok(()) };
        let (count, numbers) = (self.task.particles as usize, self.tables.numbers);
        let mut by_place = self.download(self.task.interpolated, SUMS * count, numbers)?;
        let mut by_row = vec![StencilSums::zeroed(); count];
        for (&row, sums) in self.host_rows.iter().zip(by_place.as_chunks().0) {
            by_row[row as usize] = StencilSums(*sums);
        }
        peers.collect(&mut by_row);
        for (&row, sums) in self.host_rows.iter().zip(by_place.as_chunks_mut().0) {
            if let Some(all) = by_row.get(row as usize) {
                *sums = all.0;
            }
        }
        self.device.upload(self.task.interpolated, &numbers.bytes_of(&by_place))
    }
}

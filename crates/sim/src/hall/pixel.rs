//! One pixel of an image, and the size limit of images.

use super::error::HallFault;

/// Maximum number of columns or rows of an image: a hall of the largest size, with eight pixels along a cell's side.
pub(super) const MAX_IMAGE_SIDE: u32 = 16_384;

/// Lightness and opacity of a pixel, from 0 to 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Pixel {
    /// The mean of the pixel's colours.
    pub(super) shade: f64,
    /// 0 is transparent, 1 is opaque. `None` if the image has no alpha channel.
    pub(super) alpha: Option<f64>,
}

/// Checks the size of an image. An empty image and a side longer than `MAX_IMAGE_SIDE` are errors.
pub(super) fn sides(width: u64, height: u64) -> Result<(u32, u32), HallFault> {
    if width == 0 || height == 0 {
        return Err(HallFault::EmptyImage(width, height));
    }
    let side = |pixels: u64| u32::try_from(pixels).ok().filter(|pixels| *pixels <= MAX_IMAGE_SIDE);
    side(width).zip(side(height)).ok_or(HallFault::ImageTooLarge(width, height, MAX_IMAGE_SIDE))
}

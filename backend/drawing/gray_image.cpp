// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/drawing/gray_image.hpp"

#include <cairo.h>

#include <cstring>
#include <memory>

namespace cairn {
namespace {

cairo_status_t append(void* bytes, const unsigned char* data, unsigned int length) {
  static_cast<std::string*>(bytes)->append(reinterpret_cast<const char*>(data), length);
  return CAIRO_STATUS_SUCCESS;
}

}  // namespace

Result<std::string> encode_png(const GrayImage& image) {
  constexpr std::size_t kMost = GrayImage::kMaxSide;
  if (image.width == 0 || image.height == 0 || image.width > kMost || image.height > kMost) {
    return Error{ErrorCode::kNotUsable, "a PNG file of " + std::to_string(image.width) + " x " +
                                            std::to_string(image.height) +
                                            " pixels; each side must be between 1 and " +
                                            std::to_string(kMost)};
  }
  // Cairo writes a mask as gray.
  const std::unique_ptr<cairo_surface_t, void (*)(cairo_surface_t*)> surface(
      cairo_image_surface_create(CAIRO_FORMAT_A8, static_cast<int>(image.width),
                                 static_cast<int>(image.height)),
      cairo_surface_destroy);
  std::string bytes;
  cairo_status_t status = cairo_surface_status(surface.get());
  if (status == CAIRO_STATUS_SUCCESS) {
    unsigned char* pixels = cairo_image_surface_get_data(surface.get());
    const auto stride = static_cast<std::size_t>(cairo_image_surface_get_stride(surface.get()));
    for (std::size_t row = 0; row < image.height; ++row)
      std::memcpy(pixels + row * stride, image.levels.data() + row * image.width, image.width);
    cairo_surface_mark_dirty(surface.get());
    status = cairo_surface_write_to_png_stream(surface.get(), append, &bytes);
  }
  if (status == CAIRO_STATUS_SUCCESS) return bytes;
  return Error{ErrorCode::kInternal,
               std::string("cairo cannot write a PNG file: ") + cairo_status_to_string(status)};
}

}  // namespace cairn

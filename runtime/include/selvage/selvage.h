/* Everything: per-face textures in memory, in files and on the GPU. */
#ifndef SELVAGE_SELVAGE_H
#define SELVAGE_SELVAGE_H

#include <selvage/adjacency.h>
#include <selvage/blend.h>
#include <selvage/border.h>
#include <selvage/cache.h>
#include <selvage/camera.h>
#include <selvage/displacement.h>
#include <selvage/edge_aligned.h>
#include <selvage/file.h>
#include <selvage/filter.h>
#include <selvage/form.h>
#include <selvage/gl_context.h>
#include <selvage/gl_images.h>
#include <selvage/gl_live.h>
#include <selvage/gl_material.h>
#include <selvage/gl_renderer.h>
#include <selvage/gl_residency.h>
#include <selvage/gl_strategy.h>
#include <selvage/gl_texture.h>
#include <selvage/half.h>
#include <selvage/htex.h>
#include <selvage/image.h>
#include <selvage/light.h>
#include <selvage/mesh.h>
#include <selvage/ptx.h>
#include <selvage/ptx_check.h>
#include <selvage/ptx_diff.h>
#include <selvage/ptx_resize.h>
#include <selvage/ptx_writer.h>
#include <selvage/result.h>
#include <selvage/seamless.h>
#include <selvage/source.h>
#include <selvage/stream.h>
#include <selvage/subface.h>
#include <selvage/surface.h>
#include <selvage/tessellation.h>
#include <selvage/texture.h>
#include <selvage/threads.h>
#include <selvage/triangle.h>
#include <selvage/uv_images.h>
#include <selvage/words.h>
#include <selvage/wrap.h>

#endif

// Weighted sums of tables, on the GPU. Internal.
#pragma once

#include <map>
#include <span>
#include <vector>

#include "runtime/coefficient_images.h"
#include "runtime/gl_context.h"
#include "runtime/gl_objects.h"

namespace prt {

/// Needs the context to be current.
class TableBlender {
  public:
    /// @param context  outlives this object
    explicit TableBlender(const GlContext& context);

    /// Σ weight_k · source_k.
    /// @param sources  one or more, all of one shape
    /// @param weights  as many
    /// @param result   made anew where it has another shape; none of the sources
    /// @throws InputError  larger than OpenGL takes
    void blend(std::span<const TableImage* const> sources, std::span<const float> weights,
               TableImage& result);

  private:
    void pass(std::span<const TableImage* const> sources, std::span<const float> weights, TableImage& result);
    const GlContext& context_;
    GlObject vertexArray_;
    std::map<size_t, GlProgram> programs_;  // by number of sources
};

}  // namespace prt

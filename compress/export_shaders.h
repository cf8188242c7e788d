// Shader source that evaluates what prt export writes. Internal to prt export.
#pragma once

#include <span>
#include <string>

#include "compress/quantize.h"

namespace prt {

/// What the snippets are made for.
struct ShaderSettings {
    std::string name;        ///< of the JSON file, for the comment on top
    int components = 0;      ///< PCA weights of a point; 0: none are exported
    int shCoefficients = 0;  ///< of visibility; 0: it is not exported
    bool isPerVertex = false;
    int rowLength = 0;                                          ///< points in a row of the textures
    std::span<const UnormRange> weightRanges;                   ///< [4·⌈components / 4⌉], or empty
    bool isRgbPerLayer = false;                                 ///< packing of the tables
    bool hasWeightTables = false, hasVisibilityTables = false;  ///< triple products, light × cosine
    bool hasWeightTableRanges = false, hasVisibilityTableRanges = false;
    bool hasSuns = false;  ///< extracted from the light of tables
};

/// Functions for GLSL 4.00 or later, and for HLSL (shader model 4.1 or later), equal to the project's own
/// shader.
/// @source [IwanickiSloan2012, Eq. 6]
std::string glslSnippet(const ShaderSettings& settings);
std::string hlslSnippet(const ShaderSettings& settings);

}  // namespace prt

// Figures, drawn by gnuplot where it is installed: panels of curves, of bars, and of functions on the sphere.
#pragma once

#include <array>
#include <string>
#include <vector>

namespace prt::tools {

struct Series {
    std::string name;                           ///< in the legend
    std::vector<std::array<double, 2>> points;  ///< (x, y); not finite, or ≤ 0 on a logarithmic axis: a gap
    bool dashed = false;
};

struct Bar {
    std::string name;
    double value;
    int group = 0;  ///< bars of one group share a colour
};

/// A function drawn as a surface: quads of a grid, coloured by sign.
struct Surface {
    int rows = 0, columns = 0;
    std::vector<std::array<double, 4>> points;  ///< [rows×columns] x, y, z, value, each in [−1, 1]
};

/// One panel; at most one of series, bars and surface is given, none leaves its place empty.
struct Panel {
    std::string title, xLabel = {}, yLabel = {};
    bool logX = false, logY = false;
    std::vector<Series> series = {};
    std::vector<Bar> bars = {};
    Surface surface = {};
};

struct Figure {
    std::string title;
    int columns = 1;  ///< panels in a row
    std::vector<Panel> panels;
    int panelWidthPx = 560, panelHeightPx = 460;
};

/// The gnuplot program that draws the figure.
/// @param format  "svg" or "png"
/// @param path    what it writes
std::string gnuplotScript(const Figure& figure, const std::string& format, const std::string& path);

/// Draws into `path`, whole or not at all.
/// @return false: gnuplot is not installed, nothing was written
/// @throws OutputError  the file cannot be written, or gnuplot failed
bool drawFigure(const Figure& figure, const std::string& format, const std::string& path);

}  // namespace prt::tools

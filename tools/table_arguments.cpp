#include "tools/table_arguments.h"

#include "precompute/math/table_layout.h"

namespace prt::tools {

void addTableOptions(CommandLine& line, const std::string& prefix, TableOptions& options) {
    line.choice(prefix + "layout", options.layout, TableLayout::names(),
                "how the sphere of normals is laid out in tables");
    line.integer(prefix + "size", options.size, 1, TableLayout::kMaxSize,
                 "texels along the side of a face of the tables");
    line.choice(prefix + "variant", options.variant, tableVariantNames(),
                "all bands of the cosine that matter, or the paper's three");
    line.text("--window", options.window, "NAME[:WIDTH]",
              "smooths the light against ringing: none, hanning, lanczos, gaussian; as wide as the light has "
              "bands, or a width in bands, or auto: the widest that leaves it nowhere negative");
}

void addSunOption(CommandLine& line, TableOptions& options) {
    line.flag("--extract-sun", options.extractSun,
              "the sun of an environment becomes a light of its own, with sharp shadows");
}

}  // namespace prt::tools

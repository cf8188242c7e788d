// The measurements of `prt measure`. Each takes the arguments from its own name on.
#pragma once

namespace prt::tools {

void runMeasureBake(int argc, char** argv);
void runMeasureError(int argc, char** argv);
void runMeasureFrameTime(int argc, char** argv);
void runMeasureParameterization(int argc, char** argv);
void runMeasureBasis(int argc, char** argv);
void runMeasureCompression(int argc, char** argv);
void runMeasureRotation(int argc, char** argv);
void runMeasureProduct(int argc, char** argv);
void runMeasureProjection(int argc, char** argv);
void runMeasureSampling(int argc, char** argv);
void runMeasureTables(int argc, char** argv);
void runMeasureTechniques(int argc, char** argv);

}  // namespace prt::tools

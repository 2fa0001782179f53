// Writes the particles of a dam break for DualSPHysics, by its own classes: a cube of SIDE^3 liquid
// particles in the corner of a tank twice as long, two layers of fixed particles in floor and
// sides. Prints the numbers of fixed and of liquid particles. Arguments: folder, SIDE, spacing in
// m, kernel length in m, pressure constant b in Pa.

#include "JAppInfo.h"
#include "JPartDataBi4.h"
#include <cstdio>
#include <cstdlib>
#include <vector>

// Their messages name the program by it.
JAppInfo AppInfo("bench", "1", "");

int main(int argc, char **argv) {
  if (argc != 6) return 2;
  const int side = atoi(argv[2]);
  const double s = atof(argv[3]), h = atof(argv[4]), b = atof(argv[5]);
  const int layers = 2, size[3] = {2 * side, side, side + side / 2};
  std::vector<tdouble3> fixed, liquid;
  for (int i = -layers; i < size[0] + layers; i++)
    for (int j = -layers; j < size[1] + layers; j++)
      for (int k = -layers; k < size[2]; k++) {
        const bool inside = i >= 0 && i < size[0] && j >= 0 && j < size[1] && k >= 0;
        const tdouble3 at = TDouble3((i + 0.5) * s, (j + 0.5) * s, (k + 0.5) * s);
        if (!inside) fixed.push_back(at);
        else if (i < side && k < side) liquid.push_back(at);
      }
  const unsigned count = unsigned(fixed.size() + liquid.size());
  const double mass = 1000 * s * s * s;
  std::vector<tdouble3> position(fixed);
  position.insert(position.end(), liquid.begin(), liquid.end());
  std::vector<unsigned> id(count);
  std::vector<float> density(count, 1000.f);
  std::vector<tfloat3> velocity(count, TFloat3(0));
  for (unsigned k = 0; k < count; k++) id[k] = k;
  const tdouble3 low = TDouble3(-layers * s);
  const tdouble3 high = TDouble3((size[0] + layers) * s, (size[1] + layers) * s, size[2] * s);

  JPartDataBi4 data;
  data.ConfigBasic(0, 1, "bench", "bench", "dam", false, 0, argv[1]);
  data.ConfigParticles(count, fixed.size(), 0, 0, liquid.size(), low, high);
  data.ConfigCtes(s, h, b, 1000, 7, mass, mass);
  data.ConfigSimPeri(PERI_None, TDouble3(0), TDouble3(0), TDouble3(0));
  data.AddPartInfo(0, 0, count, 0, 0, 0, low, high);
  data.AddPartData(count, id.data(), position.data(), velocity.data(), density.data());
  data.SaveFileCase("dam");
  printf("%zu %zu\n", fixed.size(), liquid.size());
}

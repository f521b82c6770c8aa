#pragma once

#include <array>

#include "fpbm/any/detail/any_path.hpp"
#include "fpbm/fpbm.hpp"

/// The examples of the paper: parameters as identified from its printed numbers, and an independent solution of each
/// case (DOP853 with a relative tolerance of 1e-12, in another implementation), accurate to 1e-9.
namespace fpbm::test {

inline constexpr double kPi = 3.14159265358979323846;
inline constexpr double kDuration = 10.0;  ///< [s]

[[nodiscard]] PlanarArm<4> paper_arm();

/// At rest in the posture of the paper.
[[nodiscard]] State<4> paper_start();

[[nodiscard]] AnyPath<Position<2>> paper_circle();
[[nodiscard]] AnyPath<Position<2>> paper_lissajous();
[[nodiscard]] AnyPath<Position<2>> paper_tricuspid();

/// W = diag(1, 2, 3, 4), the first choice of the paper.
[[nodiscard]] DiagonalWeights<4> paper_weights();

/// The scheme of the paper with α = 0.6 and k₁ = k₂ = 1, and any secondary motion.
[[nodiscard]] AccelerationScheme<4> paper_fpbm(const NullSpace<4>& null_space = {});

enum class Figure { kCircle, kLissajous, kTricuspid };

[[nodiscard]] AnyPath<Position<2>> paper_path(Figure figure);

struct PaperCase {
  Figure figure;
  double alpha;
  std::array<double, 4> weights;
  double k1;
  double k2;
  std::array<double, 4> q;   ///< At T [rad].
  std::array<double, 4> qd;  ///< At T [rad/s].
  const char* where;
};

// clang-format off
/// α = k₁ = k₂ = 0 is MAN.
inline constexpr std::array<PaperCase, 18> kPaperCases = {{
    {Figure::kCircle, 0.4, {1, 2, 3, 4}, 1.0, 1.0, {0.1822875942, 0.5210270369, 0.0353666507, 0.0879062701}, {-0.0106596323, 0.0629129099, -0.0525098202, -0.0428220656}, "Table 1"},
    {Figure::kCircle, 0.5, {1, 2, 3, 4}, 1.0, 1.0, {0.1979791682, 0.4537394028, 0.0799963333, 0.1402244944}, {-0.0116731097, 0.0455375024, -0.0346692854, -0.0223237992}, "Table 1"},
    {Figure::kCircle, 0.6, {1, 2, 3, 4}, 1.0, 1.0, {0.215222487, 0.396791734, 0.1144437012, 0.1756873322}, {-0.009312096, 0.0309612098, -0.023296645, -0.0102744949}, "Table 1, Fig. 2"},
    {Figure::kCircle, 0.7, {1, 2, 3, 4}, 1.0, 1.0, {0.2309870352, 0.3502790251, 0.1425781649, 0.1979309087}, {-0.0062682272, 0.0194638696, -0.0152966299, -0.0034458577}, "Table 1"},
    {Figure::kCircle, 0.8, {1, 2, 3, 4}, 1.0, 1.0, {0.2438990903, 0.3136662479, 0.1667196506, 0.2092975704}, {-0.0035163233, 0.0107285023, -0.0091904753, -8.2218e-05}, "Table 1"},
    {Figure::kCircle, 0.6, {1, 4, 9, 16}, 1.0, 1.0, {0.2488227669, 0.3135920776, 0.1398715621, 0.2444419835}, {-0.0027615227, 0.011886285, -0.0159280098, 0.0070609364}, "Fig. 3"},
    {Figure::kCircle, 0.6, {2, 2, 4, 4}, 1.0, 1.0, {0.2080868931, 0.4084266659, 0.1309803937, 0.1350875775}, {-0.0104684143, 0.0336996444, -0.0200448107, -0.0205815157}, "Tables 2 and 3, W_1"},
    {Figure::kCircle, 0.6, {4, 4, 9, 9}, 1.0, 1.0, {0.2139948734, 0.3906558717, 0.1396220821, 0.1483014244}, {-0.0096133842, 0.0295494271, -0.0174107829, -0.0166545037}, "Tables 2 and 3, W_2"},
    {Figure::kCircle, 0.6, {9, 9, 16, 16}, 1.0, 1.0, {0.2025163466, 0.4261963001, 0.1218629009, 0.1215035435}, {-0.0111079758, 0.0378176284, -0.0229323119, -0.0247397251}, "Tables 2 and 3, W_3"},
    {Figure::kCircle, 0.6, {2, 4, 6, 8}, 1.0, 1.0, {0.215222487, 0.396791734, 0.1144437012, 0.1756873322}, {-0.009312096, 0.0309612098, -0.023296645, -0.0102744949}, "Tables 2 and 3, W_4"},
    {Figure::kCircle, 0.6, {10, 12, 14, 16}, 1.0, 1.0, {0.1924036454, 0.4665219797, 0.0888408056, 0.105568734}, {-0.0115654757, 0.0469303954, -0.0328268349, -0.0306307252}, "Tables 2 and 3, W_5"},
    {Figure::kCircle, 0.6, {16, 16, 16, 16}, 1.0, 1.0, {0.1825380283, 0.505884152, 0.0745295953, 0.0540003777}, {-0.0102538503, 0.0554196086, -0.0398237077, -0.0472108707}, "Tables 2 and 3, W_6"},
    {Figure::kCircle, 0.0, {1, 2, 3, 4}, 0.0, 0.0, {0.5033419805, 0.5129039303, -0.3969642514, -0.2893025154}, {0.4084554269, -0.4310496783, -0.1741918894, 0.0005409667}, "Fig. 1"},
    {Figure::kLissajous, 0.0, {1, 2, 3, 4}, 0.0, 0.0, {0.2145634493, 0.6842007816, -0.1662932484, -0.122579291}, {0.0967282156, 0.0496324742, -0.182696728, -0.1571644889}, "Fig. 4"},
    {Figure::kLissajous, 0.6, {2, 4, 6, 8}, 1.0, 1.0, {0.2269571941, 0.3646622251, 0.1280477961, 0.1995257953}, {-0.0098361645, 0.0314160805, -0.0249362187, -0.0062143178}, "Fig. 5"},
    {Figure::kLissajous, 0.6, {10, 12, 14, 16}, 1.0, 1.0, {0.2132238003, 0.3990057826, 0.1213733628, 0.1628405902}, {-0.0130423226, 0.0419922893, -0.0282352377, -0.0190936678}, "Fig. 6"},
    {Figure::kTricuspid, 0.0, {1, 2, 3, 4}, 0.0, 0.0, {0.6533548193, 0.3227047977, -0.4104496247, -0.2975243176}, {0.4327113317, -0.5783252332, -0.0860883773, 0.1628524375}, "Fig. 7"},
    {Figure::kTricuspid, 0.6, {2, 4, 6, 8}, 1.0, 1.0, {0.192763114, 0.4641540132, 0.0924691992, 0.1040242824}, {-0.0154374987, 0.0620360252, -0.0429833796, -0.0407232182}, "Fig. 8"},
}};
// clang-format on

}  // namespace fpbm::test

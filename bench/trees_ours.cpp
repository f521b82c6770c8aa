#include "trees.hpp"

namespace bench {
namespace {

[[maybe_unused]] const bool kAdded = (add_tree<OurTree, TwoPandas>(), add_tree<OurTree, UpperBody>(), true);

}  // namespace
}  // namespace bench

/// Two lists of each kind of mesh on a GPU, with the bits of the host.
#include <collide/cuda.cuh>

#include "lists.hpp"

int cuda_devices() { return collide::cuda_device_count(); }

namespace {

template <class List>
void check_on_gpu() {
  using tests::pairs::checked_list;
  for (auto const how : checked_list<List>::surfaces()) {
    CAPTURE(int(how));
    checked_list<List>({how, 0}, collide::host(1)).check_space(collide::cuda_shared());
  }
}

}  // namespace

TEST_CASE("pairs: on a GPU: two lists with bodies that move") {
  check_on_gpu<tests::pairs::list_1>();
  check_on_gpu<tests::pairs::list_3>();
}
TEST_CASE("pairs: on a GPU: two lists with driven bodies") {
  check_on_gpu<tests::pairs::list_2>();
  check_on_gpu<tests::pairs::list_4>();
}
TEST_CASE("pairs: on a GPU: two lists with a fixed mesh") {
  check_on_gpu<tests::pairs::list_5>();
  check_on_gpu<tests::pairs::list_6>();
}

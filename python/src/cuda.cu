// The module for arrays in the memory of NVIDIA GPUs.
#include "module.hpp"
#include "runtime_cuda.cuh"

NB_MODULE(_cuda, m) {
  using namespace collide_python;
  bind<collide::cuda_shared>(m);
  m.def("own_stream", [](int device) { return reinterpret_cast<std::uintptr_t>(own_stream(device)); });
  m.def("order", [](int device, std::uintptr_t first, std::uintptr_t second) {
    on_device const here(device);
    order(reinterpret_cast<cudaStream_t>(first), reinterpret_cast<cudaStream_t>(second));
  });
  m.def("capability", [](int device) {
    auto const number = [&](cudaDeviceAttr of) {
      int found = 0;
      collide::cuda_check(cudaDeviceGetAttribute(&found, of, device), "cudaDeviceGetAttribute");
      return found;
    };
    return 10 * number(cudaDevAttrComputeCapabilityMajor) + number(cudaDevAttrComputeCapabilityMinor);
  });
  m.def("device_count", &collide::cuda_device_count);
}

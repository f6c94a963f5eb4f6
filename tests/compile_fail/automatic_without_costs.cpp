// expect: collide: automatic needs an execution space with a static member costs, see detail/execution/tuning.hpp
#include <collide/automatic.cuh>
#include <collide/count.hpp>

class costless : public collide::host {
 public:
  using host::host;

 private:
  using host::costs;
};

int main() {
  collide::detector<collide::automatic, collide::karabassi<>, costless> detector;
  detector.query(collide::sphere_view<float>(), collide::count());
}

// Compiles where nobody asks for warnings: a narrowing, a shadow, a name that nothing uses.
#include <obliq/client/client.h>

int main(int argc, char**) {
  int unused = 3;
  const char narrow = argc * 1000;
  {
    int argc = narrow;
    if (argc == 17) return 1;
  }
  return 0;
}

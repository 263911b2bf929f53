/* The C interface as it is installed. */
#include <obliq/client/c.h>

int main(void) {
  obliq_client* client = obliq_open();
  const int outcome = obliq_connect(client, "nowhere:at:all", "consumer", NULL);
  obliq_close(client);
  return outcome == OBLIQ_BAD_ARGUMENT ? 0 : 1;
}

#include "acd/transfer.h"

#include "capture/joint_csv.h"

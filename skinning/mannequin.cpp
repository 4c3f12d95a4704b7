#include "skinning/mannequin.h"

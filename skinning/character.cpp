#include "skinning/character.h"

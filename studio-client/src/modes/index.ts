// The modes, in the order of the rail.

import "./look";
import "./points";
import "./pull";
import "./surface";
import "./axial";
import "./sites";
import "./cage";
import "./transfer";
import "./model";
import "./face";
import "./time";

// Contact theory of one corner: Eqs. (1)-(9).
#pragma once

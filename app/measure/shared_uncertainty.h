// What an input that all frames share does to a contact: lens, yaw. Its error
// is in no pose's u; it comes in once, at the end.
#pragma once

#include <string>
#include <vector>

#include "touchdown/vision/contact/contact.h"

namespace touchdown::pipeline {

// The contacts again, with an input moved.
struct MovedContacts {
  vision::ContactResult contacts;
  double weight = 1.0;  // of the squared change
};

// Adds `source` to every uncertainty and to the budgets (JCGM 100, 5.1.2): the
// changes of a quantity, squared and weighted, add up. One result moved by one
// standard deviation has the weight 1; two, moved up and down, 1/2 each. Where
// a quantity is absent in a moved result, that one says nothing of it.
void AddShared(vision::ContactResult& contacts, const std::string& source,
               const std::vector<MovedContacts>& moved);

}  // namespace touchdown::pipeline

"""How bodies meet: point gaps, rims, rubs, disks, what turns them and pulls at them."""

"""Does a contact that stays closed diverge? Poles, coincidences, Floquet, maps of growth."""

"""Many flights. Studies return data; `uavsim.views` draws it."""

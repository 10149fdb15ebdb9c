"""A course that is prescribed: a push along a rail, then leg after leg in the air, as arrays over the time of a record.

`push` moves a point along the rail, `legs` says how fast and where to it flies through the air from then on, and
`attitude` turns the body that carries the sensors. Whatever begins or ends does so at a row of the record.
"""

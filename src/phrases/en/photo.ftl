# A piece of luggage with its photo: the page of a photo, and the pieces in lists.

photo-photo = Photo
photo-can-be-enlarged = Photo, can be enlarged
photo-of = Photo of luggage #{ $id }
photo-of-newest = Photo { $take } of { $newest } of luggage #{ $id }, the newest
photo-of-earlier = Photo { $take } of { $newest } of luggage #{ $id }, an earlier one
photo-found = The bag was found at column { $column }, row { $row } on { $found }.
photo-decided = The bag was found at column { $column }, row { $row } on { $found }; the verdict was given on { $decided } by { $who }.
photo-before = ← Luggage #{ $id }
photo-after = Luggage #{ $id } →
photo-every = All photos of this piece
photo-take = photo { $take }
photo-take-newest = photo { $take }, the newest
photo-smaller = Smaller
photo-whole = 1×: the whole photo
photo-larger = Larger

## In a list

piece-no-photo = no photo
piece-found = found { $time } at { $cell }
piece-decided = decided { $time } by { $who }
piece-secured = secured { $time }

## What was decided of it

